#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "framework/calibration/circumstances.h"
#include "framework/calibration/closing.h"
#include "framework/calibration/simulate.h"
#include "framework/cli/commands.h"
#include "framework/cli/terminal.h"
#include "framework/page/contents.h"
#include "framework/report/progress.h"

namespace talus {
namespace {

struct Options {
  Common common;
  std::string model, poses = "65", grid, file = "-", points, html;
  double noise = 1;
};

// Does the grid say what this coordinate is?
bool is_named(const std::string& grid, const std::string& name) {
  for (std::size_t at = 0; at < grid.size();) {
    const std::size_t end = std::min(grid.find(';', at), grid.size());
    std::string word = grid.substr(at, std::min(grid.find('=', at), end) - at);
    std::erase(word, ' ');
    if (word == name) return true;
    at = end + 1;
  }
  return false;
}

// Settings in which the loops are closed: drawn, or with what the grid or the table says.
Settings closed_settings(Program& program, const std::optional<Settings>& drawn, const Options& o,
                         std::vector<std::string>& warnings) {
  ClosingOptions options;
  options.noise = o.noise, options.seed = o.common.seed, options.threads = o.common.thread_count();
  const std::vector<Coordinate> list = coordinates(program);
  options.held.assign(list.size(), false);
  if (drawn && o.grid.empty()) {
    const int count = static_cast<int>(drawn->poses.size());
    Settings settings = random_closed_settings(program, count, options);
    if (const int found = static_cast<int>(settings.poses.size()); found < count)
      warnings.push_back(
          fmt::format("Only {} of {} postures were found that close the loops.", found, count));
    return settings;
  }
  options.attempts = 40;
  Recordings table;
  Settings settings;
  if (drawn) {
    settings = *drawn;
    for (std::size_t i = 0; i < list.size(); ++i) options.held[i] = is_named(o.grid, list[i].name);
  } else {
    table = read_recordings(o.poses);
    for (const MeasuredColumn& c : program.columns)
      if (table.find(c.name))  // postures that reach what was measured
        return with_circumstances(program, settings_from(program, table, options.threads), &table);
    options.table = &table;
    settings = random_settings(program, static_cast<int>(table.rows()), o.common.seed);
    for (std::size_t i = 0; i < list.size(); ++i)
      if ((options.held[i] = table.find(list[i].column) != nullptr))
        for (std::size_t k = 0; k < table.rows(); ++k)
          settings.poses[k][i] = table.get(list[i].column, list[i].dimension).values[k];
  }
  Closed closed = close_loops(program, std::move(settings), options);
  if (const auto open = std::count(closed.reached.begin(), closed.reached.end(), false))
    warnings.push_back(fmt::format("In {} of {} postures the loops cannot be closed.", open,
                                   closed.reached.size()));
  return std::move(closed.settings);
}

void run(const Options& o) {
  check_writable(o.file);
  check_html(o.html, {o.poses, o.model});
  check_writable(o.points);
  check_apart(o.file, {o.poses, o.model});
  check_apart(o.points, {o.poses, o.model});
  if (!o.points.empty() && o.points == o.file)
    throw InputError({o.points, 0, 0}, "--points and --recordings name one file", "two files");
  Registry registry = o.common.registry();
  const Model model = open_model(o.model, registry, o.common);
  Program program = compile(model, registry);
  std::vector<std::string> warnings;
  auto bar = std::make_unique<Progress>(!o.common.quiet, "simulating");
  std::optional<Settings> settings = drawn_settings(program, o.poses, o.grid, o.common.seed);
  if (has_loops(program)) {
    settings = closed_settings(program, settings, o, warnings);
  } else if (!settings) {
    const Recordings table = read_recordings(o.poses);
    settings =
        with_circumstances(program, settings_from(program, table, o.common.thread_count()), &table);
  }
  Recordings recordings =
      simulate(program, *settings, {o.common.seed, o.noise, o.common.thread_count()});
  const std::string origin =
      fmt::format("# simulated from {} by talus {}, seed {}, noise {:g} times the stated sigmas\n",
                  o.model, TALUS_VERSION, o.common.seed, o.noise);
  if (!o.html.empty()) {
    PageContent page = page_content("simulate", model, o.common, {});
    page_of_simulation(page, program, *settings, recordings);
    put_page(o.html, page);
  }
  std::string points;
  if (!o.points.empty()) {  // the probed features are in the points, not in the recordings
    if (!is_probed(program))
      throw InputError({o.model, 0, 0}, "--points: nothing in this model is probed",
                       "a feature with probed=\"...\"");
    for (const Feature& f : program.features)
      for (int c : f.columns)
        if (f.probed)
          std::erase_if(recordings.columns, [&](const RecordedColumn& column) {
            return column.name == program.columns[c].name;
          });
    for (const ProbedShape& s : program.shapes)
      if (o.noise > 0 && !s.sigma && s.through.empty())
        warnings.push_back(
            fmt::format("'{}' states no sigma; its points are without noise.", s.name));
    points =
        origin + write_points(simulate_points(program, settings->poses, o.common.seed, o.noise));
  }
  const std::string table = origin + write_recordings(recordings);
  bar.reset();
  if (!o.points.empty()) put(o.points, points);
  put(o.file, table);
  for (const std::string& warning : warnings) warn(warning);
}

}  // namespace

void add_simulate(CLI::App& app) {
  CLI::App* command =
      add_command(app, "simulate", "recordings from a model, with noise from its sigmas");
  auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "model file (.xml or .lua)")->required();
  command
      ->add_option(
          "--poses", o->poses,
          "how many random poses, or a CSV file with the readings or with the frames to reach")
      ->capture_default_str();
  command->add_option("--grid", o->grid,
                      "every combination: \"encoder1=-20:20:10; encoder2=0,30,60\"");
  command->add_option("--noise", o->noise, "times the stated sigmas")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  command->add_option("--recordings", o->file, "file to write (- for standard output)")
      ->capture_default_str();
  command->add_option("--points", o->points, "file to write the points of probed features to")
      ->type_name("FILE");
  add_html(*command, o->html);
  add_common(*command, o->common, true, false);
  add_seed(*command, o->common);
  add_quiet(*command, o->common);
  add_threads(*command, o->common);
  command->callback([o] { run(*o); });
}

}  // namespace talus
