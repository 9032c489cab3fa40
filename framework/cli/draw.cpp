#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <list>
#include <memory>

#include "framework/calibration/inverse.h"
#include "framework/cli/commands.h"
#include "framework/cli/terminal.h"
#include "framework/report/draw.h"
#include "framework/report/draw_canvas.h"
#include "framework/report/draw_film.h"
#include "framework/report/draw_video.h"
#include "framework/report/progress.h"
#include "framework/report/report.h"

namespace talus {
namespace {

struct Options {
  Common common;
  std::string model, recordings, poses, grid, picture, animation, size = "1000x750", frames;
  std::vector<std::string> ghosts;
  int pose = 0, between = 0;
  double rate = 12;
  DrawOptions draw;
};

// Where the linkage is to be shown.
struct Poses {
  Settings settings;
  std::vector<int> numbers;  // from 1
  std::string word;          // what they are called: row, pose
};

bool whole(const std::vector<double>& pose) {
  return std::all_of(pose.begin(), pose.end(), [](double v) { return std::isfinite(v); });
}

Recordings only_row(Recordings recordings, int row) {
  for (RecordedColumn& column : recordings.columns) column.values = {column.values[row]};
  recordings.lines = {recordings.lines[row]};
  if (recordings.use) recordings.use = {{(*recordings.use)[row]}};
  return recordings;
}

void check_pose(int pose, std::size_t count, const std::string& word) {
  if (pose > 0 && static_cast<std::size_t>(pose) > count)
    throw InputError({fmt::format("--pose {}", pose), 0, 0},
                     fmt::format("there {} {} {}{}", count == 1 ? "is" : "are", count, word,
                                 count == 1 ? "" : "s"),
                     fmt::format("1 to {}", count));
}

// A linkage whose readings are recorded is shown where they say; otherwise it must reach what was
// measured. What was found, and what could not be, is told.
Settings coordinates_of(Program& program, const Recordings& recordings, const Options& o) {
  const bool sensed =
      std::all_of(program.readings.begin(), program.readings.end(),
                  [&](const Reading& r) { return r.covariate || recordings.find(r.column); });
  Recovered found;
  {
    const Progress bar(!o.common.quiet, "postures");
    found = recover(program, recordings, sensed ? Reach::nearest : Reach::exactly,
                    o.common.thread_count());
  }
  std::vector<std::string> still;
  for (const Unknown& u : program.unknowns)
    if (u.per.empty() && !recordings.find(u.name) &&
        std::find(found.solved.begin(), found.solved.end(), u.name) == found.solved.end())
      still.push_back(u.name);
  if (!found.solved.empty() && !o.common.quiet)
    show(
        fmt::format("{}: {} found from what was measured.\n", recordings.file, join(found.solved)));
  if (!still.empty())
    warn(fmt::format("{} has no column {}: there the model's start is shown.", recordings.file,
                     join(still, " nor ")));
  return found.settings;
}

Poses from_table(Program& program, const std::string& file, const Options& o) {
  Recordings recordings = read_recordings(file);
  Poses poses{.word = "row"};
  check_pose(o.pose, recordings.rows(), poses.word);
  for (std::size_t k = 1; k <= recordings.rows(); ++k) poses.numbers.push_back(static_cast<int>(k));
  if (o.pose > 0 && o.animation.empty()) {  // where the others cannot be reached is of no interest
    recordings = only_row(std::move(recordings), o.pose - 1);
    poses.numbers = {o.pose};
  }
  poses.settings = coordinates_of(program, recordings, o);
  auto& all = poses.settings.poses;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (poses.numbers[k] == o.pose && !whole(all[k]))
      throw InputError({file, recordings.lines[k], 0}, "this row lacks a reading",
                       "another --pose");
  for (std::size_t k = all.size(); k-- > 0;)  // rows that lack a reading are left out
    if (!whole(all[k])) {
      all.erase(all.begin() + static_cast<std::ptrdiff_t>(k));
      poses.numbers.erase(poses.numbers.begin() + static_cast<std::ptrdiff_t>(k));
    }
  if (all.empty())
    throw InputError({file, 0, 0}, "no row has all readings", "at least one to be drawn");
  return poses;
}

Poses poses_of(Program& program, const Options& o) {
  if (!o.recordings.empty() + !o.poses.empty() + !o.grid.empty() > 1)
    throw InputError({"talus draw", 0, 0}, "recordings, --poses and --grid exclude each other",
                     "one of them");
  if (!o.recordings.empty()) return from_table(program, o.recordings, o);
  Poses poses{.word = "pose"};
  if (auto drawn = drawn_settings(program, o.poses, o.grid, o.common.seed))
    poses.settings = std::move(*drawn);
  else if (!o.poses.empty())
    return from_table(program, o.poses, o);
  else
    poses.settings = {{resting_pose(program)}};
  check_pose(o.pose, poses.settings.poses.size(), poses.word);
  for (std::size_t k = 1; k <= poses.settings.poses.size(); ++k)
    poses.numbers.push_back(static_cast<int>(k));
  return poses;
}

void read_size(const std::string& text, DrawOptions& draw) {
  const std::size_t by = text.find('x');
  auto side = [&](const std::string& word) {
    if (word.empty() || word.size() > 5 ||
        word.find_first_not_of("0123456789") != std::string::npos || std::stoi(word) < 100 ||
        std::stoi(word) > 20000)
      throw InputError({"--size " + text, 0, 0}, "no such size",
                       "WIDTHxHEIGHT in pixels, each 100 to 20000: 1000x750");
    return std::stoi(word);
  };
  draw.width = side(text.substr(0, by));
  draw.height = side(by == std::string::npos ? "" : text.substr(by + 1));
}

std::string ending_of(const std::string& file, const std::vector<std::string>& known) {
  std::string ending = std::filesystem::path(file).extension().string();
  if (std::find(known.begin(), known.end(), ending) == known.end())
    throw InputError({file, 0, 0}, "unknown ending", "one of: " + join(known),
                     nearest(ending, known));
  return ending;
}

// The models to compare with. A list, since what is drawn keeps pointers to them.
std::list<Program> ghosts_of(const Options& o) {
  std::list<Program> ghosts;
  Common plain = o.common;
  plain.sets.clear();
  for (const std::string& file : o.ghosts) {
    Registry registry = o.common.registry();
    ghosts.push_back(compile(open_model(file, registry, plain), registry));
  }
  return ghosts;
}

struct Drawer {
  const Program& program;
  const std::list<Program>& ghosts;
  const Options& o;

  std::vector<Picture> operator()(const Settings& settings, const std::vector<std::string>& titles,
                                  const std::function<void(double)>& progress = {}) const {
    std::vector<DrawnLinkage> others;
    auto file = o.ghosts.begin();
    for (const Program& ghost : ghosts) {
      // A calibrated model has the name of its nominal one: then the file tells them apart.
      const bool same = ghost.name.empty() || ghost.name == program.name;
      others.push_back({&ghost, same_poses(program, settings, ghost, {*file, 0, 0}),
                        same ? std::filesystem::path(*file).filename().string() : ghost.name});
      ++file;
    }
    DrawOptions options = o.draw;
    options.titles = titles;
    options.progress = progress;
    return draw({&program, settings}, others, options);
  }
};

void write_picture(const Drawer& drawer, const Poses& poses, const std::filesystem::path& folder) {
  const Options& o = drawer.o;
  std::size_t k = 0;
  if (o.pose > 0)
    k = static_cast<std::size_t>(std::find(poses.numbers.begin(), poses.numbers.end(), o.pose) -
                                 poses.numbers.begin());
  std::vector<std::string> titles;
  if (poses.numbers.size() > 1 || o.pose > 0)
    titles.push_back(fmt::format("{} {}", poses.word, poses.numbers[k]));
  const Picture picture = drawer({{poses.settings.poses[k]}}, titles)[0];
  const std::string& title = drawer.program.name;
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  if (error)
    throw InputError({folder.string(), 0, 0}, "cannot be made: " + error.message(), "--out DIR");
  put(o.picture, o.picture.ends_with(".png")   ? write_png(picture)
                 : o.picture.ends_with(".pdf") ? write_pdf(picture, title)
                                               : write_svg(picture, title));
  if (!o.common.quiet) show(fmt::format("Picture: {}\n", o.picture));
}

void write_animation(const Drawer& drawer, const Poses& poses) {
  const Options& o = drawer.o;
  const Settings settings = interpolated(drawer.program, poses.settings, o.between);
  if (settings.poses.size() > 5000)
    throw InputError({o.animation, 0, 0}, fmt::format("{} pictures", settings.poses.size()),
                     "at most 5000: fewer rows or a smaller --between");
  Film film{.title = drawer.program.name, .rate = o.rate};
  for (std::size_t i = 0; i < settings.poses.size(); ++i) {
    const std::size_t k = i / (static_cast<std::size_t>(o.between) + 1);
    film.titles.push_back(fmt::format("{} {}", poses.word, poses.numbers[k]));
    if (i % (static_cast<std::size_t>(o.between) + 1))
      film.titles.back() += fmt::format(" to {}", poses.numbers[k + 1]);
  }
  auto bar = std::make_unique<Progress>(!o.common.quiet, "drawing");
  const bool video = !o.animation.ends_with(".html") && !o.animation.ends_with(".svg");
  film.pictures = drawer(settings, film.titles,
                         [&](double share) { (*bar)("drawing", video ? 0.5 * share : share); });
  if (o.animation.ends_with(".html")) {
    put(o.animation, write_film_html(film));
  } else if (o.animation.ends_with(".svg")) {
    put(o.animation, write_film_svg(film));
  } else if (!write_video(o.animation, film.pictures, film.rate,
                          [&](double share) { (*bar)("encoding", 0.5 + 0.5 * share); })) {
    bar.reset();
    complain(o.animation, "ffmpeg could not write it");
    exit_code() = 1;
    return;
  }
  bar.reset();
  if (!o.common.quiet)
    show(fmt::format("Animation: {} ({} pictures)\n", o.animation, film.pictures.size()));
}

void run(Options& o) {
  const std::filesystem::path folder = o.common.out.empty() ? "." : o.common.out;
  if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder))
    throw InputError({folder.string(), 0, 0}, "is no folder", "--out DIR");
  const bool own_name = o.picture.empty() && o.animation.empty();
  if (own_name)
    o.picture = (folder / (std::filesystem::path(o.model).stem().string() + ".svg")).string();
  if (!o.picture.empty()) ending_of(o.picture, {".svg", ".png", ".pdf"});
  std::string ending;
  if (!o.animation.empty())
    ending = ending_of(o.animation, {".html", ".svg", ".gif", ".mp4", ".webm"});
  if (!own_name) check_writable(o.picture);
  check_writable(o.animation);
  if (!ending.empty() && ending != ".html" && ending != ".svg" && !ffmpeg_found()) {
    complain(o.animation, fmt::format("the program ffmpeg makes {} files, and it is not installed; "
                                      ".html and .svg need nothing",
                                      ending));
    exit_code() = 1;
    return;
  }
  read_size(o.size, o.draw);
  for (const std::string& name : CLI::detail::split(o.frames, ','))
    if (const std::string trimmed = CLI::detail::trim_copy(name); !trimmed.empty())
      o.draw.frames.push_back(trimmed);
  Registry registry = o.common.registry();
  Program program = compile(open_model(o.model, registry, o.common), registry);
  const std::list<Program> ghosts = ghosts_of(o);
  const Poses poses = poses_of(program, o);
  const Drawer drawer{program, ghosts, o};
  if (!o.picture.empty()) write_picture(drawer, poses, own_name ? folder : "");
  if (!o.animation.empty()) write_animation(drawer, poses);
}

}  // namespace

void add_draw(CLI::App& app) {
  CLI::App* command = add_command(app, "draw", "a picture or an animation of a linkage");
  auto o = std::make_shared<Options>();
  auto option = [&](const char* name, auto& value, const char* type, const char* meaning) {
    return command->add_option(name, value, meaning)->type_name(type);
  };
  command->add_option("model", o->model, "model file (.xml or .lua)")->required();
  command->add_option("recordings", o->recordings, "recordings (.csv or .trc): where it stands");
  option("--picture", o->picture, "FILE", ".svg, .png or .pdf (default: MODEL.svg in --out)");
  option("--animation", o->animation, "FILE",
         "all poses one after the other: .html, .svg, or .gif, .mp4, .webm by ffmpeg");
  option("--pose", o->pose, "N", "the row of the picture, counted from 1 (default: the first)")
      ->check(CLI::Range(1, 10000000));
  option("--poses", o->poses, "N|FILE",
         "as many random poses, or a CSV file as talus simulate reads");
  option("--grid", o->grid, "GRID", "every combination: \"encoder1=-20:20:10; encoder2=0,30\"");
  option("--between", o->between, "N", "pictures put in between every two poses of the animation")
      ->check(CLI::Range(0, 1000));
  option("--rate", o->rate, "N", "pictures a second")
      ->check(CLI::Range(0.1, 120.0))
      ->capture_default_str();
  option("--ghost", o->ghosts, "MODEL", "another model in the same posture, in thin lines")
      ->allow_extra_args(false);
  option("--view", o->draw.view, "VIEW", "front, side, top, iso, or \"azimuth, elevation\" in deg")
      ->capture_default_str();
  option("--up", o->draw.up, "AXIS", "the axis that points up: x, y, z, -x, -y, -z")
      ->capture_default_str();
  option("--hold", o->draw.hold, "FRAME", "the frame that stands still (default: the root)");
  option("--frames", o->frames, "NAMES",
         "frames shown with axes and name, or all (default: ends of chains, measured, with limbs)");
  option("--size", o->size, "WxH", "pixels")->capture_default_str();
  add_common(*command, o->common, true, false);
  command->add_option("--out", o->common.out, "folder for MODEL.svg")->type_name("DIR");
  add_seed(*command, o->common);
  add_threads(*command, o->common);
  add_quiet(*command, o->common);
  command->callback([o] { run(*o); });
}

}  // namespace talus
