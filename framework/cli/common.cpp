#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <thread>

#include "framework/calibration/split_options.h"
#include "framework/cli/commands.h"
#include "framework/cli/terminal.h"
#include "framework/report/report.h"

namespace talus {

Registry Common::registry() const {
  Registry registry = Registry::built_in();
  for (const std::string& file : plugins) load_plugin(file, registry);
  return registry;
}

int Common::thread_count() const {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description) {
  return app.add_subcommand(name, description);
}

void add_color(CLI::App& command) {
  command
      .add_option_function<std::string>(
          "--color",
          [](const std::string& when) {
            colours() = when == "always"  ? Colours::always
                        : when == "never" ? Colours::never
                                          : Colours::automatic;
          },
          "colours: auto (on a terminal, where NO_COLOR is not set), always, never")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->type_name("WHEN");
}

void add_quiet(CLI::App& command, Common& common) {
  command.add_flag("--quiet", common.quiet,
                   "no report and no progress bar: only files, warnings and errors");
}

void add_json(CLI::App& command, Common& common) {
  command.add_option("--json", common.json, "write the results as JSON (- for standard output)")
      ->type_name("FILE");
}

void add_seed(CLI::App& command, Common& common) {
  command.add_option("--seed", common.seed, "seed of all random choices")->capture_default_str();
}

void add_threads(CLI::App& command, Common& common) {
  command
      .add_option("--threads", common.threads,
                  "threads (default: one per core); results do not depend on it")
      ->check(CLI::Range(1, 1024));
}

void add_common(CLI::App& command, Common& common, bool model, bool results) {
  command.add_option("--plugin", common.plugins, "load a plugin: FILE.so or FILE.lua")
      ->type_name("FILE")
      ->allow_extra_args(false);
  if (model)
    command
        .add_option("--set", common.sets,
                    "change one attribute: joint2.a=\"300 ?\", residual=\"position\"")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false);
  if (results) {
    command.add_option("--out", common.out, "folder for the files written")->type_name("DIR");
    add_json(command, common);
    add_seed(command, common);
    add_threads(command, common);
    add_quiet(command, common);
  }
  add_color(command);
}

static void names_of(const Element& element, std::vector<std::string>& names) {
  for (const Element& child : element.children) {
    if (!child.name().empty()) names.push_back(child.name());
    names_of(child, names);
  }
}

Model open_model(const std::string& file, Registry& registry, const Common& common) {
  Model model = read_model(file, registry);
  for (const std::string& set : common.sets) {
    const Place place{"--set " + set, 0, 0};
    const std::size_t equals = set.find('=');
    if (equals == std::string::npos || equals == 0)
      throw InputError(place, equals ? "no '=' found" : "no name before '='", "NAME=VALUE");
    const std::string name = set.substr(0, equals), value = set.substr(equals + 1);
    const std::size_t dot = name.find('.');
    if (Element* named = dot == std::string::npos ? model.root.find_named(name) : nullptr) {
      named->set("value", value);  // a <parameter>, <constant> or <unknown>
    } else if (name == "length" || name == "angle" || name == "name") {
      model.root.set(name, value);
    } else if (dot == std::string::npos || name.substr(0, dot) == "calibrate") {
      bool any = false;
      for (Element& child : model.root.children)
        if (child.tag == "calibrate")
          child.set(name.substr(dot == std::string::npos ? 0 : dot + 1), value), any = true;
      if (!any)
        model.root.children.push_back(
            {"calibrate",
             {{name.substr(dot == std::string::npos ? 0 : dot + 1), value, place}},
             {},
             place});
    } else {
      Element* element = model.root.find_named(name.substr(0, dot));
      std::vector<std::string> names;
      names_of(model.root, names);
      if (!element)
        throw InputError(place, fmt::format("no element '{}'", name.substr(0, dot)),
                         "one of: " + join(names), nearest(name.substr(0, dot), names));
      element->set(name.substr(dot + 1), value);
    }
  }
  if (!common.sets.empty()) check_grammar(model, registry);
  return model;
}

// A measured frame's quaternion must be one: normalised it may be by rounding only.
static void check_quaternions(const Program& program, const Recordings& recordings) {
  for (const Feature& f : program.features) {
    if (f.kind != Kind::frame || f.columns.size() != 7) continue;
    std::vector<const RecordedColumn*> q;
    for (std::size_t i = 3; i < 7; ++i)
      q.push_back(recordings.find(program.columns[f.columns[i]].name));
    if (std::find(q.begin(), q.end(), nullptr) != q.end()) continue;
    for (std::size_t k = 0; k < recordings.rows(); ++k) {
      double square = 0;
      for (const RecordedColumn* c : q) square += c->values[k] * c->values[k];
      if (std::abs(std::sqrt(square) - 1) > 0.01)
        throw InputError(
            {recordings.file, recordings.lines[k], 0},
            fmt::format("the quaternion of '{}' has length {:.3g}", f.name, std::sqrt(square)),
            "a unit quaternion: w, x, y, z");
    }
  }
}

void check_apart(const std::string& out, const std::vector<std::string>& inputs) {
  std::error_code ignored;
  for (const std::string& in : inputs)
    if (!out.empty() && !in.empty() && out != "-" && std::filesystem::equivalent(out, in, ignored))
      throw InputError({out, 0, 0}, "would be written over what is read", "another file");
}

Measured open_recordings(const Program& program, const std::string& file,
                         const std::string& points_file) {
  Measured measured{read_recordings(file), {}, {}, {}, {}};
  if (!is_probed(program)) {
    if (!points_file.empty())
      throw InputError({points_file, 0, 0}, "the model has nothing that is probed",
                       "a feature with probed=\"...\"");
    check_quaternions(program, measured.recordings);
    return measured;
  }
  check_quaternions(program, measured.recordings);
  // What is recorded already needs no points; asked for by name, they come first.
  std::string missing;
  for (const Feature& f : program.features)
    for (int c : f.columns)
      if (f.probed && !measured.recordings.find(program.columns[c].name))
        missing = program.columns[c].name;
  if (points_file.empty() && missing.empty()) return measured;
  const std::filesystem::path beside = std::filesystem::path(file).parent_path() / "points.csv";
  if (points_file.empty() && !std::filesystem::exists(beside))
    throw InputError({file, 0, 0},
                     fmt::format("there are no probed points, and no column '{}'", missing),
                     "--points FILE, or points.csv beside the recordings");
  return measure(program, std::move(measured.recordings),
                 read_points(points_file.empty() ? beside.string() : points_file));
}

void add_points(CLI::App& command, std::string& points_file) {
  command
      .add_option("--points", points_file,
                  "probed points of a coordinate measuring machine (default: points.csv beside "
                  "the recordings, where these lack the columns of probed features)")
      ->type_name("FILE");
}

std::optional<Settings> drawn_settings(const Program& program, const std::string& poses,
                                       const std::string& grid, std::uint64_t seed) {
  if (!grid.empty()) return grid_settings(program, grid);
  if (poses.empty() || poses.find_first_not_of("0123456789") != std::string::npos) return {};
  if (poses.size() > 7 || std::stoi(poses) == 0 || std::stoi(poses) > 1000000)
    throw InputError({"--poses " + poses, 0, 0}, "no such number of poses",
                     "1 to 1000000, or a CSV file");
  return random_settings(program, std::stoi(poses), seed);
}

void check_writable(const std::string& file) {
  if (file.empty() || file == "-") return;
  const std::filesystem::path path(file),
      folder = path.has_parent_path() ? path.parent_path() : ".";
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error))
    throw InputError({file, 0, 0},
                     "cannot be written: there is no folder '" + folder.string() + "'");
  if (std::filesystem::is_directory(path, error))
    throw InputError({file, 0, 0}, "cannot be written: it is a folder");
}

void put(const std::string& file, const std::string& text) {
  if (file == "-")
    fmt::print("{}", text);
  else
    write_file(file, text);
}

void add_split(CLI::App& command, double& check, std::vector<std::string>& groups) {
  command
      .add_option("--check", check, "share of the groups held out, where there is no column `use`")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 0.9));
  command
      .add_option(
          "--group", groups,
          "columns whose equal rows stay on one side of the split: star, or location,hole together")
      ->allow_extra_args(false);
}

SplitOptions split_options(const Program& program, const Recordings& recordings, double check,
                           const std::vector<std::string>& groups, std::uint64_t seed) {
  std::vector<std::vector<std::string>> columns;
  for (const std::string& list : groups) columns.push_back(CLI::detail::split(list, ','));
  return split_options(program, recordings, check, columns, seed);
}

}  // namespace talus
