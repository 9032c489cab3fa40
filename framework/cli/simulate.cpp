#include <fmt/format.h>

#include <memory>

#include "framework/calibration/circumstances.h"
#include "framework/calibration/simulate.h"
#include "framework/cli/commands.h"

namespace talus {
namespace {

struct Options {
  Common common;
  std::string model, poses = "65", grid, file = "-", points;
  double noise = 1;
};

void run(const Options& o) {
  check_writable(o.file);
  check_writable(o.points);
  check_apart(o.file, {o.poses, o.model});
  check_apart(o.points, {o.poses, o.model});
  if (!o.points.empty() && o.points == o.file)
    throw InputError({o.points, 0, 0}, "--points and --recordings name one file", "two files");
  Registry registry = o.common.registry();
  Program program = compile(open_model(o.model, registry, o.common), registry);
  std::optional<Settings> settings = drawn_settings(program, o.poses, o.grid, o.common.seed);
  if (!settings) {
    const Recordings table = read_recordings(o.poses);
    settings =
        with_circumstances(program, settings_from(program, table, o.common.thread_count()), &table);
  }
  Recordings recordings =
      simulate(program, *settings, {o.common.seed, o.noise, o.common.thread_count()});
  const std::string origin =
      fmt::format("# simulated from {} by talus {}, seed {}, noise {:g} times the stated sigmas\n",
                  o.model, TALUS_VERSION, o.common.seed, o.noise);
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
        fmt::print(stderr, "Warning: '{}' states no sigma; its points are without noise.\n",
                   s.name);
    points =
        origin + write_points(simulate_points(program, settings->poses, o.common.seed, o.noise));
  }
  const std::string table = origin + write_recordings(recordings);
  if (!o.points.empty()) put(o.points, points);
  put(o.file, table);
}

}  // namespace

void add_simulate(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("simulate", "recordings from a model, with noise from its sigmas");
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
  add_common(*command, o->common, true, false);
  command->add_option("--seed", o->common.seed, "seed of all random choices")
      ->capture_default_str();
  command->add_option("--threads", o->common.threads, "threads")->check(CLI::Range(1, 1024));
  command->callback([o] { run(*o); });
}

}  // namespace talus
