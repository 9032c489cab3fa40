#include <fmt/format.h>

#include <memory>

#include "framework/cli/commands.h"
#include "framework/report/report.h"

namespace talus {
namespace {

struct Options {
  Common common;
  std::string model, recordings, points, table;
};

void run(const Options& o) {
  check_writable(o.table);
  check_apart(o.table, {o.recordings, o.points, o.model});
  Registry registry = o.common.registry();
  const Program program = compile(open_model(o.model, registry, o.common), registry);
  if (!is_probed(program))
    throw InputError({o.model, 0, 0}, "nothing in this model is probed",
                     "a feature with probed=\"...\"");
  const Measured measured = open_recordings(program, o.recordings, o.points);
  if (o.table != "-") fmt::print("{}", probing_text(program, measured));
  for (const std::string& warning : measured.warnings) fmt::print(stderr, "Warning: {}\n", warning);
  if (!o.table.empty())
    put(o.table,
        fmt::format("# measured by {} from probed points, talus {}\n", o.model, TALUS_VERSION) +
            write_recordings(measured.recordings));
}

}  // namespace

void add_measure(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "measure", "features measured by probed points: fits of the shapes, datums, a table");
  auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "model file (.xml or .lua)")->required();
  command->add_option("recordings", o->recordings, "recordings, with a column `pose`")->required();
  add_points(*command, o->points);
  command
      ->add_option("--table", o->table,
                   "file for the recordings with the measured columns (- for standard output)")
      ->type_name("FILE");
  add_common(*command, o->common, true, false);
  command->callback([o] { run(*o); });
}

}  // namespace talus
