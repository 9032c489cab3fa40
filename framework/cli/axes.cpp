#include <memory>

#include "framework/calibration/axes_changes.h"
#include "framework/calibration/linkage_poses.h"
#include "framework/cli/axes_words.h"
#include "framework/cli/terminal.h"
#include "framework/page/contents.h"
#include "framework/report/axes.h"
#include "framework/report/progress.h"

namespace talus {
namespace {

struct Options {
  Common common;
  AxesWords words;
  std::string model, linkage, arcs, actual, html;
  std::vector<std::string> recordings;
  std::size_t zero = 0;
  int restarts = 2;
};

void run(const Options& o) {
  check_writable(o.common.json);
  check_html(o.html, {o.model});
  Registry registry = o.common.registry();
  const Model model = open_model(o.model, registry, o.common);
  const Program program = compile(model, registry);
  AxisFinder finder(program, o.words.of, o.words.reverse);
  AxesOptions options;
  options.locate.fit.threads = o.common.thread_count();
  options.locate.fit.seed = o.common.seed;
  options.locate.fit.restarts = o.restarts;
  options.by = o.words.by;
  options.anatomical = o.words.anatomical();
  if (o.zero > 0) options.zero = o.zero - 1;
  if (!o.arcs.empty()) options.arcs = parse_arcs(o.arcs, program.units);
  options.labels = o.words.axis_labels();

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
    Progress bar(!o.common.quiet, "axes");
    options.progress = [&](double share) { bar("axes", share); };
    result = find_axes(finder, recordings, options, actual ? &*actual : nullptr);
  }
  const AxesContext context{o.model, o.linkage, o.actual, o.recordings, options.labels};
  if (!o.common.json.empty()) put(o.common.json, axes_json(finder, result, context));
  if (!o.html.empty()) {
    PageContent page = page_content("axes", model, o.common, o.recordings);
    page.report_json = axes_json(finder, result, context);
    page.report_text = axes_text(finder, result, context);
    page_of_axes(page, finder, result, recordings, o.recordings);
    put_page(o.html, page);
  }
  if (o.common.report_wanted()) show(axes_text(finder, result, context));
  for (std::size_t r = 0; r < recordings.size(); ++r)
    for (const std::string& w : result.whole.located[r].fit.warnings)
      if (w.starts_with("The solver") || w.starts_with("Another set"))
        warn(o.recordings[r] + ": " + w);
  bool any = false, converged = true;
  for (const Located& l : result.whole.located) {
    converged &= l.fit.converged;
    for (const LocatedAxis& a : l.axes) any |= a.determined;
  }
  exit_code() = any && converged ? 0 : 1;
}

}  // namespace

void add_axes(CLI::App& app) {
  CLI::App* command = add_command(
      app, "axes",
      "where the hinges of a measured motion lie, and how they changed between recordings");
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
  add_axes_words(*command, o->words);
  command
      ->add_option("--zero", o->zero,
                   "row of the reference that shows zero flexion (default: the model's zero)")
      ->check(CLI::PositiveNumber);
  command->add_option(
      "--arcs", o->arcs,
      "arcs of the motion, each on its own: \"20:80, 30:90\"; of the angle of --by, which here may "
      "also be a column of the recordings");
  command
      ->add_option("--actual", o->actual,
                   "table of the true changes, one row per changed recording")
      ->type_name("FILE");
  command->add_option("--restarts", o->restarts, "further starts, scattered over the tolerances")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  add_html(*command, o->html);
  add_common(*command, o->common, true, false);
  add_quiet(*command, o->common);
  add_json(*command, o->common);
  add_seed(*command, o->common);
  add_threads(*command, o->common);
  command->callback([o] { run(*o); });
}

}  // namespace talus
