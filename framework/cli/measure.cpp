#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "framework/cli/commands.h"
#include "framework/cli/terminal.h"
#include "framework/report/layout.h"
#include "framework/report/progress.h"
#include "framework/report/verdict.h"

namespace talus {
namespace {

struct Options {
  Common common;
  std::string model, recordings, points, table;
};

std::string report(const Program& program, const Measured& measured) {
  if (measured.shapes.empty())
    return "The recordings have the measured columns already; no points were read.\n";
  const auto worst = std::max_element(measured.shapes.begin(), measured.shapes.end(),
                                      [](auto& a, auto& b) { return a.worst < b.worst; });
  std::size_t points = 0, poses = 0;
  for (const ShapeQuality& s : measured.shapes)
    points += s.points, poses = std::max(poses, s.poses);
  const Unit unit = program.units.length;
  return text_of({"MEASURED",
                  fmt::format("{} in {}, from {}",
                              counted(measured.shapes.size(), "probed shape", "probed shapes"),
                              counted(poses, "pose", "poses"), counted(points, "point", "points")),
                  {fmt::format("The points lie farthest from their shape at {} in pose {:g}: {} {} "
                               "(root mean square).",
                               worst->name, worst->worst_pose, figure(worst->worst / unit.factor),
                               unit.text)}}) +
         "\n" + probing_text(program, measured);
}

void run(const Options& o) {
  check_writable(o.table);
  check_apart(o.table, {o.recordings, o.points, o.model});
  Registry registry = o.common.registry();
  const Program program = compile(open_model(o.model, registry, o.common), registry);
  if (!is_probed(program))
    throw InputError({o.model, 0, 0}, "nothing in this model is probed",
                     "a feature with probed=\"...\"");
  Measured measured;
  {
    const Progress bar(!o.common.quiet, "measuring");
    measured = open_recordings(program, o.recordings, o.points);
  }
  if (!o.common.quiet && o.table != "-") show(report(program, measured));
  for (const std::string& warning : measured.warnings) warn(warning);
  if (!o.table.empty())
    put(o.table,
        fmt::format("# measured by {} from probed points, talus {}\n", o.model, TALUS_VERSION) +
            write_recordings(measured.recordings));
}

}  // namespace

void add_measure(CLI::App& app) {
  CLI::App* command = add_command(
      app, "measure", "features measured by probed points: fits of the shapes, datums, a table");
  auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "model file (.xml or .lua)")->required();
  command->add_option("recordings", o->recordings, "recordings, with a column `pose`")->required();
  add_points(*command, o->points);
  command
      ->add_option("--table", o->table,
                   "file for the recordings with the measured columns (- for standard output)")
      ->type_name("FILE");
  add_common(*command, o->common, true, false);
  add_quiet(*command, o->common);
  command->callback([o] { run(*o); });
}

}  // namespace talus
