#include "framework/calibration/study.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>

#include "framework/cli/axes_words.h"
#include "framework/cli/study_words.h"
#include "framework/cli/terminal.h"
#include "framework/report/layout.h"
#include "framework/report/progress.h"
#include "framework/report/resumable_table.h"

namespace talus {
namespace {

struct Options {
  Common common;
  AxesWords words;
  std::string linkage, motion, vary, noise = "0.01 deg", grid, poses, table;
  int trials = 200;
};

Program linkage_program(const Options& o, const std::vector<std::string>& design) {
  Registry registry = o.common.registry();
  Common common;
  common.sets = o.common.sets;
  common.sets.insert(common.sets.end(), design.begin(), design.end());
  return compile(open_model(o.linkage, registry, common), registry);
}

std::string contents(const Model& model) {
  std::string all;
  for (const std::string& file : model.sources) {
    std::ifstream in(file, std::ios::binary);
    all += (std::ostringstream() << in.rdbuf()).str() + '\n';
  }
  return all;
}

// What people look at first; everything else stands in the table.
std::vector<std::string> summary_row(const std::string& design, double noise, const StudyRow& row,
                                     const UnitSystem& units, std::size_t poses) {
  std::vector<std::string> cells{design.empty() ? "as it is" : design,
                                 fmt::format("{:.4g}", noise / units.angle.factor)};
  if (row.unreachable > 0) {
    const std::string why = fmt::format("{} of {} poses cannot be reached", row.unreachable, poses);
    cells.insert(cells.end(), {"-", "-", why});
    return cells;
  }
  double position = 0, lean = 0;
  for (std::size_t i = 0; i < row.rmse.size(); ++i)
    (i % 4 < 2 ? position : lean) = std::max(i % 4 < 2 ? position : lean, row.rmse[i]);
  cells.push_back(figure(position / units.length.factor));
  cells.push_back(figure(lean / units.angle.factor));
  if (row.outside > 0)
    cells.push_back(fmt::format("{} of {} poses outside a sensor's range", row.outside, poses));
  return cells;
}

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : ""; }

void run(const Options& o) {
  check_writable(o.table);
  if (o.grid.empty() == o.poses.empty())
    throw InputError({"talus study", 0, 0},
                     o.grid.empty() ? "no motion to apply" : "both --grid and --poses",
                     "--grid \"angle=0:110:10; ...\" or --poses FILE");
  const std::vector<Varied> varied = parse_vary(o.vary);
  const auto designs = designs_of(varied);
  const std::vector<double> noises = parse_noise(o.noise);

  Registry registry = o.common.registry();
  const Model motion_model = open_model(o.motion, registry, {});
  Program motion_program = compile(motion_model, registry);
  StudiedMotion::Choices choices{o.words.of, o.words.by, o.words.anatomical(), o.words.reverse};
  std::string poses_text;
  Settings settings;
  if (!o.grid.empty()) {
    settings = grid_settings(motion_program, o.grid);
  } else {
    const Recordings poses = read_recordings(o.poses);
    poses_text = write_recordings(poses);
    settings.poses.resize(poses.rows());
    for (const Unknown& u : motion_program.unknowns)
      for (std::size_t k = 0; k < poses.rows(); ++k) {
        settings.poses[k].push_back(poses.get(u.name, u.dimension).values[k]);
        if (std::isnan(settings.poses[k].back()))
          throw InputError({o.poses, poses.lines[k], 0},
                           fmt::format("column '{}' is empty", u.name), "the angle of the motion");
      }
  }
  const StudiedMotion motion(motion_program, settings, choices);
  const UnitSystem& units = motion_program.units;

  const AxisLabels labels = o.words.axis_labels();
  std::string header;
  for (const Varied& v : varied) header += v.name + ",";
  header += fmt::format("noise[{}],trials,poses,outside,unreachable", units.angle.text);
  std::vector<std::string> names;
  std::vector<Unit> unit;
  for (std::size_t k = 0; k < motion.finder().hinges().size(); ++k)
    for (std::size_t v = 0; v < 4; ++v) {
      names.push_back(motion.finder().hinges()[k].name + "." +
                      labels.of(motion.views()[k].main)[v]);
      unit.push_back(v < 2 ? units.length : units.angle);
      header += fmt::format(",{0} rmse[{1}],{0} se[{1}]", names.back(), unit.back().text);
    }

  // Everything that a row depends on.
  std::string fixed = contents(motion_model) + poses_text;
  {
    Registry again = o.common.registry();
    fixed += contents(open_model(o.linkage, again, {}));
    for (const std::string& file : o.common.plugins) {
      std::ifstream in(file, std::ios::binary);
      fixed += (std::ostringstream() << in.rdbuf()).str();
    }
  }
  fixed += TALUS_VERSION;
  fixed += fmt::format("{}|{}|{}|{}|{}|{}|{}|{}|{}", o.vary, o.noise, o.grid, o.trials,
                       o.common.seed, join(o.common.sets, "|"), o.words.of + "|" + o.words.by,
                       o.words.frames, join(o.words.reverse, "|"));
  ResumableTable table(o.table, "talus study", fixed, header);
  const std::size_t all = designs.size() * noises.size(), before = table.rows().size();
  if (before > all)
    throw InputError({o.table, 0, 0}, fmt::format("{} rows", before),
                     fmt::format("at most the {} of this study", all));
  auto sets_of = [&](std::size_t d) {
    std::vector<std::string> sets;
    for (std::size_t i = 0; i < varied.size(); ++i)
      sets.push_back(varied[i].name + "=" + designs[d][i]);
    return sets;
  };
  // Names and units that are wrong are said before anything is computed.
  for (const std::size_t d : {std::size_t{0}, designs.size() - 1}) {
    const Program program = linkage_program(o, sets_of(d));
    LinkagePoses(program, motion.finder().feature());
  }

  auto bar = std::make_unique<Progress>(!o.common.quiet, "study");
  StudyOptions options{o.trials, o.common.thread_count(), o.common.seed, {}};
  std::size_t row = before;
  Table summary({"<design", ".noise, " + units.angle.text, ".position, " + units.length.text,
                 ".orientation, " + units.angle.text, "<"});
  while (row < all) {
    const std::size_t d = row / noises.size();
    const std::vector<std::string> sets = sets_of(d);
    Program program = linkage_program(o, sets);
    const StudiedDesign design(program, motion, options.threads);
    for (; row < (d + 1) * noises.size(); ++row) {
      options.progress = [&](double share) {
        (*bar)(fmt::format("design {}", d + 1),
               (static_cast<double>(row) + share) / static_cast<double>(all));
      };
      const double noise = noises[row % noises.size()];
      const StudyRow result = design.run(noise, d, options);
      std::string text;
      for (const std::string& value : designs[d]) text += value + ",";
      text += fmt::format("{:g},{},{},{},{}", noise / units.angle.factor, result.trials,
                          motion.poses().rows(), result.outside, result.unreachable);
      for (std::size_t i = 0; i < names.size(); ++i)
        text += fmt::format(",{},{}", cell(result.rmse[i] / unit[i].factor),
                            cell(result.error[i] / unit[i].factor));
      table.add(text);
      summary.row(summary_row(join(sets, " "), noise, result, units, motion.poses().rows()));
    }
  }
  bar.reset();
  if (o.table.empty()) {
    put("-", table.text());
  } else if (!o.common.quiet) {
    show(fmt::format("{} of {} designs with {} of noise: {}{}\n", counted(all, "row", "rows"),
                     designs.size(), counted(noises.size(), "size", "sizes"), o.table,
                     before > 0 ? fmt::format(" ({} were there already)", before) : "") +
         (summary.empty()
              ? ""
              : "\nLargest root mean square error of any position and any orientation\n" +
                    summary.text()));
  }
}

}  // namespace

void add_study(CLI::App& app) {
  CLI::App* command = add_command(
      app, "study", "how well linkages of several designs would find the axes of a motion");
  auto o = std::make_shared<Options>();
  command->add_option("linkage", o->linkage, "model of the linkage")->required();
  command->add_option("motion", o->motion, "hinges whose nominal places are the truth")->required();
  command->add_option("--grid", o->grid,
                      "the motion: every combination: \"flexion=0:110:10; rotation=-15,0,15\"");
  command
      ->add_option("--poses", o->poses,
                   "the motion: a CSV file with a column for each of its unknown angles")
      ->type_name("FILE");
  command->add_option("--vary", o->vary,
                      "attributes of the linkage: \"joint2.d=250:350:50; joint3.a=280,300\"");
  command
      ->add_option("--noise", o->noise, "standard deviations of the encoders: \"0.005, 0.01 deg\"")
      ->capture_default_str();
  command->add_option("--trials", o->trials, "trials of each design and noise")
      ->check(CLI::Range(2, 1000000))
      ->capture_default_str();
  command
      ->add_option("--table", o->table,
                   "file for the rows (otherwise standard output); the same command again goes on "
                   "where it stopped")
      ->type_name("FILE");
  add_axes_words(*command, o->words);
  add_common(*command, o->common, true, false);
  add_quiet(*command, o->common);
  add_seed(*command, o->common);
  add_threads(*command, o->common);
  command->callback([o] { run(*o); });
}

}  // namespace talus
