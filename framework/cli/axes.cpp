#include <fmt/format.h>

#include <memory>

#include "framework/calibration/axes_changes.h"
#include "framework/calibration/linkage_poses.h"
#include "framework/cli/commands.h"
#include "framework/report/axes.h"
#include "framework/report/progress.h"

namespace talus {
namespace {

struct Options {
  Common common;
  std::string model, linkage, of, by, frames = "body", labels, arcs, actual;
  std::vector<std::string> recordings, reverse;
  std::size_t zero = 0;
  int restarts = 2;
};

AxisLabels labels_of(const Options& o) {
  AxisLabels labels;
  if (o.frames == "anatomical") labels = {{"A-P", "M-L", "P-D"}, {"V-V", "F-E", "I-E"}};
  if (o.labels.empty()) return labels;
  const auto words = CLI::detail::split(o.labels, ',');
  if (words.size() != 6)
    throw InputError({"--labels " + o.labels, 0, 0}, fmt::format("{} names", words.size()),
                     "six: along x, y, z, then about x, y, z, such as A-P,M-L,P-D,V-V,F-E,I-E");
  for (std::size_t i = 0; i < 3; ++i) {
    labels.along[i] = CLI::detail::trim_copy(words[i]);
    labels.about[i] = CLI::detail::trim_copy(words[i + 3]);
  }
  return labels;
}

void run(const Options& o) {
  check_writable(o.common.json);
  Registry registry = o.common.registry();
  const Program program = compile(open_model(o.model, registry, o.common), registry);
  AxisFinder finder(program, o.of, o.reverse);
  AxesOptions options;
  options.locate.fit.threads = o.common.thread_count();
  options.locate.fit.seed = o.common.seed;
  options.locate.fit.restarts = o.restarts;
  options.by = o.by;
  options.anatomical = o.frames == "anatomical";
  if (o.zero > 0) options.zero = o.zero - 1;
  if (!o.arcs.empty()) options.arcs = parse_arcs(o.arcs, program.units);
  options.labels = labels_of(o);

  std::vector<Recordings> recordings;
  for (const std::string& file : o.recordings) recordings.push_back(read_recordings(file));
  if (!o.linkage.empty()) {
    Registry of_linkage = o.common.registry();
    const Program linkage = compile(open_model(o.linkage, of_linkage, {}), of_linkage);
    LinkagePoses poses(linkage, finder.feature());
    for (Recordings& table : recordings) table = poses.measured(table, program);
    options.locate.observed = true;  // the encoders' noise makes errors of its own pattern
  }
  std::optional<Recordings> actual;
  if (!o.actual.empty()) actual = read_recordings(o.actual);
  AxesResult result;
  {
    Progress bar("axes");
    options.progress = [&](double share) { bar(share); };
    result = find_axes(finder, recordings, options, actual ? &*actual : nullptr);
  }
  const AxesContext context{o.model, o.linkage, o.actual, o.recordings, options.labels};
  if (!o.common.json.empty()) put(o.common.json, axes_json(finder, result, context));
  if (!o.common.quiet && o.common.json != "-") fmt::print("{}", axes_text(finder, result, context));
  bool any = false, converged = true;
  for (const Located& l : result.whole.located) {
    converged &= l.fit.converged;
    for (const LocatedAxis& a : l.axes) any |= a.determined;
  }
  exit_code() = any && converged ? 0 : 1;
}

}  // namespace

void add_axes(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "axes", "where the hinges of a measured motion lie, and how they changed between recordings");
  auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "hinges between two bodies, one measured in the other")
      ->required();
  command
      ->add_option("recordings", o->recordings,
                   "recordings of the motion; the first is the reference, others show changes")
      ->required();
  command
      ->add_option("--linkage", o->linkage,
                   "model of the linkage whose readings the recordings hold instead of the frame")
      ->type_name("FILE");
  command->add_option("--of", o->of, "the measured frame, where the model has several");
  command->add_option("--by", o->by,
                      "the flexing hinge, or a column of the recordings: what arcs are of "
                      "(default: the first hinge)");
  command
      ->add_option("--frames", o->frames,
                   "describe axes in the bodies' own frames, or in anatomical ones made from the "
                   "reference (flexion axis: y; z: along the other axis)")
      ->check(CLI::IsMember({"body", "anatomical"}))
      ->capture_default_str();
  command->add_option("--labels", o->labels,
                      "names along x, y, z and about x, y, z: A-P,M-L,P-D,V-V,F-E,I-E");
  command->add_option("--reverse", o->reverse, "a hinge whose axis is to point the other way")
      ->allow_extra_args(false);
  command
      ->add_option("--zero", o->zero,
                   "row of the reference that shows zero flexion (default: the model's zero)")
      ->check(CLI::PositiveNumber);
  command->add_option("--arcs", o->arcs, "arcs of the motion, each on its own: \"20:80, 30:90\"");
  command
      ->add_option("--actual", o->actual,
                   "table of the true changes, one row per changed recording")
      ->type_name("FILE");
  command->add_option("--restarts", o->restarts, "further starts, scattered over the tolerances")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  add_common(*command, o->common, true, false);
  command->add_flag("--quiet", o->common.quiet, "print results only to files");
  command->add_option("--json", o->common.json, "write the results as JSON (- for standard output)")
      ->type_name("FILE");
  command->add_option("--seed", o->common.seed, "seed of all random choices")
      ->capture_default_str();
  command
      ->add_option("--threads", o->common.threads,
                   "threads (default: one per core); results do not depend on it")
      ->check(CLI::Range(1, 1024));
  command->callback([o] { run(*o); });
}

}  // namespace talus
