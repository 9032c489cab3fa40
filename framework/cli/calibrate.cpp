#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>

#include "framework/calibration/circumstances.h"
#include "framework/calibration/fit.h"
#include "framework/cli/commands.h"
#include "framework/cli/terminal.h"
#include "framework/page/contents.h"
#include "framework/report/progress.h"
#include "framework/report/report.h"

namespace talus {
namespace {

struct Options {
  Common common;
  std::string model, recordings, points, sweep, html;
  double check = 0.3;
  std::vector<std::string> groups;
  int folds = 0;
  std::string solver = "auto";
  bool without_priors = false;
  FitOptions fit;
};

// One fit after the other, all of them one bar.
struct Fitting {
  explicit Fitting(bool wanted) : bar(wanted, "fitting") {}
  Progress bar;
  int all = 1, done = 0;

  Fit operator()(const std::string& step, const Program& program, const Recordings& recordings,
                 const Split& split, FitOptions options) {
    options.progress = [&](double share) { bar(step, (done + share) / all); };
    options.progress(0);
    Fit fit = calibrate(program, recordings, split, options);
    ++done;
    return fit;
  }
};

Program compiled(const Model& model, const Registry& registry, const Options& o) {
  Program program = compile(model, registry);
  if (o.without_priors)
    for (Parameter& p : program.parameters) p.nominal.tolerance.reset();
  return program;
}

std::vector<FoldStep> fold(const Program& program, const Recordings& recordings, const Split& split,
                           const Options& o, Fitting& fitting) {
  std::vector<FoldStep> steps;
  const auto all = folds(split.group, o.folds, o.common.seed);
  if (all.empty())
    throw InputError({o.recordings, 0, 0}, "--folds: all rows are one group", "two groups or more");
  for (const auto& held : all) {
    Split fold;
    fold.check = held;
    std::set<std::size_t> out_of(held.begin(), held.end());
    for (std::size_t k = 0; k < recordings.rows(); ++k)
      if (!out_of.contains(k)) fold.fit.push_back(k);
    const Fit fit =
        fitting(fmt::format("fold {}", steps.size() + 1), program, recordings, fold, o.fit);
    steps.push_back({held.size(), fit.fit_rms, fit.heldout_rms});
  }
  return steps;
}

// Weights w and 1 - w for the two residuals of <calibrate>; the best by the check rows' RMSE in %
// of full scale.
std::vector<SweepStep> sweep(Model& model, const Registry& registry, const Recordings& recordings,
                             const Options& o, Fitting& fitting) {
  double first = 0, last = 1, step = 0.1;
  if (std::sscanf(o.sweep.c_str(), "%lf:%lf:%lf", &first, &last, &step) != 3 || !(step > 0) ||
      last < first || first < 0 || last > 1)
    throw InputError({"--sweep " + o.sweep, 0, 0}, "not a range of weights",
                     "first:last:step within 0 to 1, such as 0:1:0.05");
  const int count = static_cast<int>(std::floor((last - first) / step + 1e-9));
  if (count > 1000)
    throw InputError({"--sweep " + o.sweep, 0, 0}, fmt::format("{} weights", count + 1),
                     "at most 1001");
  if (std::none_of(model.root.children.begin(), model.root.children.end(),
                   [](const Element& e) { return e.tag == "calibrate"; }))
    throw InputError({o.model, 0, 0}, "--sweep needs a <calibrate> element with two residuals");
  fitting.all += count + 1;
  std::vector<SweepStep> steps;
  for (int i = 0; i <= count; ++i) {
    const double w = first + i * step;
    for (Element& child : model.root.children)
      if (child.tag == "calibrate") child.set("weight", fmt::format("{:.10g}, {:.10g}", w, 1 - w));
    const Program program = compiled(model, registry, o);
    const Split split = split_rows(
        recordings, split_options(program, recordings, o.check, o.groups, o.common.seed));
    const Fit fit = fitting(fmt::format("weight {:.3g}", w), program, recordings, split, o.fit);
    double mean = 0;
    int counted = 0;
    for (const Measure& m : fit.measures_check)
      if (std::isfinite(m.percent_fsr)) mean += m.percent_fsr, ++counted;
    if (counted == 0)
      throw InputError("--sweep needs rows held out, and measures with a full-scale range");
    mean /= counted;
    steps.push_back({w, mean, fit.iterations, fit.measures_check});
  }
  const double best = steps[best_of(steps)].weight;
  for (Element& child : model.root.children)
    if (child.tag == "calibrate")
      child.set("weight", fmt::format("{:.10g}, {:.10g}", best, 1 - best));
  return steps;
}

void run(Options& o) {
  const std::filesystem::path folder = o.common.out.empty() ? "." : o.common.out;
  if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder))
    throw InputError({folder.string(), 0, 0}, "is no folder", "--out DIR");
  check_writable(o.common.json);
  check_html(o.html, {o.model, o.recordings, o.points});
  Registry registry = o.common.registry();
  Model model = open_model(o.model, registry, o.common);
  Measured measured;
  {
    const Program nominal = compile(model, registry);
    measured = open_recordings(nominal, o.recordings, o.points);
    measured.recordings = with_derived(nominal, measured.recordings);
  }
  Recordings& recordings = measured.recordings;
  o.fit.threads = o.common.thread_count();
  o.fit.seed = o.common.seed;
  o.fit.solver = o.solver == "gram" ? FitOptions::Solver::gram
                 : o.solver == "qr" ? FitOptions::Solver::qr
                                    : FitOptions::Solver::automatic;
  ReportContext context{"calibrate", o.model, o.recordings, &measured};
  auto fitting = std::make_unique<Fitting>(!o.common.quiet);
  fitting->all += o.folds > 1 ? o.folds : 0;
  if (!o.sweep.empty()) context.sweep = sweep(model, registry, recordings, o, *fitting);
  const Program program = compiled(model, registry, o);
  const Split split =
      split_rows(recordings, split_options(program, recordings, o.check, o.groups, o.common.seed));
  fitting->all += depends_on_loads(program) ? 1 : 0;
  Fit fit = (*fitting)("fitting", program, recordings, split, o.fit);
  if (depends_on_loads(program)) {  // once more, with the loads at the geometry found
    recordings = with_derived(program, recordings, fit.x);
    fit = (*fitting)("fitting again", program, recordings, split, o.fit);
  }
  fit.warnings.insert(fit.warnings.begin(), measured.warnings.begin(), measured.warnings.end());
  if (o.folds > 1) context.folds = fold(program, recordings, split, o, *fitting);
  fitting.reset();
  const std::string text = text_report(program, fit, context);

  Model calibrated = calibrated_model(model, program, fit);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw InputError({folder.string(), 0, 0}, "cannot be made: " + error.message(), "--out DIR");
  const bool lua = o.model.ends_with(".lua");
  const std::string file = (folder / (std::filesystem::path(o.model).stem().string() +
                                      (lua ? "-calibrated.lua" : "-calibrated.xml")))
                               .string();
  move_plugin_paths(calibrated, o.model, file);
  if (!o.common.json.empty()) put(o.common.json, json_report(program, fit, context));
  write_file(file, lua ? write_lua(calibrated) : write_xml(calibrated));
  if (!o.html.empty()) {
    PageContent page =
        page_content("calibrate", model, o.common, {o.recordings, measured.points_file});
    page.report_json = json_report(program, fit, context);
    page.report_text = text;
    page_of_fit(page, program, recordings, split, fit);
    put_page(o.html, page);
  }
  if (o.common.report_wanted()) show(fmt::format("{}\nCalibrated model: {}\n", text, file));
  for (const std::string& warning : fit.warnings) warn(warning);
  exit_code() = fit.converged ? 0 : 1;
}

}  // namespace

void add_calibrate(CLI::App& app) {
  CLI::App* command = add_command(
      app, "calibrate", "fit a model's free parameters to recordings; writes the calibrated model");
  auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "model file (.xml or .lua)")->required();
  command->add_option("recordings", o->recordings, "recordings (.csv or .trc)")->required();
  add_split(*command, o->check, o->groups);
  command->add_option("--folds", o->folds, "also hold out every group once, in this many folds")
      ->check(CLI::Range(2, 1000));
  command->add_option("--sweep", o->sweep, "try weights w, 1-w of two residuals: first:last:step");
  command->add_flag("--without-priors", o->without_priors,
                    "tolerances do not pull: every ± counts as ?, as in the papers");
  command
      ->add_option("--restarts", o->fit.restarts, "further starts, scattered over the tolerances")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  command
      ->add_option("--iterations", o->fit.max_iterations,
                   "iteration limit of each stage (least squares, weights anew, the loss or "
                   "published objective)")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--solver", o->solver, "auto, gram (normal equations) or qr")
      ->check(CLI::IsMember({"auto", "gram", "qr"}))
      ->capture_default_str();
  add_points(*command, o->points);
  add_html(*command, o->html);
  add_common(*command, o->common, true, true);
  command->callback([o] { run(*o); });
}

}  // namespace talus
