#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "framework/calibration/circumstances.h"
#include "framework/calibration/fit.h"
#include "framework/calibration/settings.h"
#include "framework/cli/commands.h"
#include "framework/kinematics/posture.h"
#include "framework/page/contents.h"
#include "framework/report/report.h"

namespace talus {
namespace {

std::string chain_text(const Program& program) {
  std::string out = "Frames\n";
  std::function<void(int, int)> branch = [&](int frame, int depth) {
    std::string names;
    for (const auto& [name, index] : program.frame_index)
      if (index == frame && name != program.frames[frame].name) names += " = " + name;
    out += fmt::format("  {:{}}{}{}\n", "", 2 * depth, program.frames[frame].name, names);
    for (std::size_t f = 0; f < program.frames.size(); ++f)
      if (program.frames[f].parent == frame) branch(static_cast<int>(f), depth + 1);
  };
  branch(0, 0);
  if (!program.limbs.empty()) out += "Limbs\n";
  for (const Limb& limb : program.limbs) {
    const Unit unit = program.units.of(length);
    const Eigen::Vector3d size = limb.size / unit.factor;
    out += fmt::format("  {:<14} {:.4g} x {:.4g} x {:.4g} {}, at {}\n", limb.name, size.x(),
                       size.y(), size.z(), unit.text, program.frames[limb.frame].name);
  }
  out += "Readings\n";
  for (const Reading& r : program.readings)
    if (!r.covariate)
      out += fmt::format("  {:<14} {:<10} {}\n", r.sensor, r.column,
                         formula(r.value, program.slot_names));
  std::vector<std::string> circumstances;
  for (const Reading& r : program.readings)
    if (r.covariate) {  // the load of a joint has many columns
      const bool load = r.column.starts_with("load:");
      const std::string name =
          load ? "load of " + r.column.substr(5, r.column.find_last_of('.') - 5) : r.column;
      if (std::find(circumstances.begin(), circumstances.end(), name) == circumstances.end())
        circumstances.push_back(name);
    }
  if (!circumstances.empty()) out += fmt::format("Circumstances: {}\n", join(circumstances));
  if (!program.unknowns.empty()) out += "Unknowns\n";
  for (const Unknown& u : program.unknowns)
    out += fmt::format("  {:<14} per {}\n", u.name, u.per.empty() ? "pose" : join(u.per));
  out += "Measured features\n";
  for (const Feature& f : program.features)
    out += fmt::format("  {:<14} {} of {} in {}\n", f.name, f.tag, program.chains[f.chain].at,
                       program.chains[f.chain].in);
  out += "Residual rows\n";
  for (const Row& row : program.rows)
    out += fmt::format("  {:<14} {}\n", row.measure,
                       row.sigma ? fmt::format("sigma {:.4g} {}",
                                               *row.sigma / program.units.of(row.dimension).factor,
                                               program.units.of(row.dimension).text)
                                 : "no stated sigma");
  out += fmt::format("{} free parameters\n", program.parameters.size());
  std::size_t width = 20;
  for (const Parameter& p : program.parameters) width = std::max(width, p.name.size());
  for (const Parameter& p : program.parameters)
    out += fmt::format("  {:<{}} {} {}\n", p.name, width,
                       write_quantity(p.nominal, p.dimension, program.units),
                       program.units.of(p.dimension).text);
  return out;
}

// Angle and shortest distance between the axes of joints that follow each other along the tree,
// with readings at zero and unknowns at their start.
std::string axes_text(const Program& program) {
  Posture posture(program);
  std::vector<double> rest;
  for (const Coordinate& c : coordinates(program)) rest.push_back(c.rest);
  posture.set(rest);
  const std::vector<JointAxis>& axes = posture.axes();
  const Unit mm = program.units.length, degrees = program.units.angle;
  std::string out;
  for (std::size_t b = 0; b < axes.size(); ++b) {
    const int a = axis_before(program, axes, b);
    if (a < 0) continue;
    const JointAxis* before = &axes[a];
    const Apart between = apart(*before, axes[b]);
    const double acute = std::min(between.angle, 180 * deg - between.angle);
    if (!std::isfinite(acute) || !std::isfinite(between.distance)) continue;
    auto shown = [](double v) { return v < 1e-9 ? 0 : v; };  // rounding is not a distance
    if (before->frame == axes[b].frame && shown(acute) == 0 && shown(between.distance) == 0)
      continue;  // two coordinates that turn one joint about one axis
    out += fmt::format("  {:<30} {:>10.4g} {} {:>12.4g} {}\n",
                       before->joint + " - " + axes[b].joint, shown(acute) / degrees.factor,
                       degrees.text, shown(between.distance) / mm.factor, mm.text);
  }
  return out.empty() ? out : "Joint axes: angle and distance, readings at zero\n" + out;
}

void run(const std::string& model_file, const std::string& recordings_file,
         const std::string& points_file, const std::string& html, const Common& common) {
  check_html(html, {model_file, recordings_file, points_file});
  Registry registry = common.registry();
  const Model model = open_model(model_file, registry, common);
  const Program program = compile(model, registry);
  PageContent page = page_content("check", model, common, {recordings_file, points_file});
  page.report_text = chain_text(program) + axes_text(program);
  fmt::print("{}\n{}", program.name, page.report_text);
  if (recordings_file.empty()) {
    page_of_model(page, program);
    put_page(html, page);
    return;
  }
  const Measured measured = open_recordings(program, recordings_file, points_file);
  const Recordings recordings = with_derived(program, measured.recordings);
  fmt::print("{}", probing_text(program, measured));
  std::vector<std::size_t> rows(recordings.rows());
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = k;
  Problem problem(program, recordings, rows, Groups(program, recordings), {});
  const Identifiability seen = identify(problem, problem.start(), 1, program.units);
  fmt::print("{} poses; at the nominal values {} of {} directions are seen\n", rows.size(),
             seen.seen, problem.size());
  for (const std::string& sentence : seen.unseen) fmt::print("  - {}\n", sentence);
  if (problem.data().missing()) fmt::print("{} residuals lack a value\n", problem.data().missing());
  if (html.empty()) return;
  page_of_check(page, program, recordings, seen, problem.start());
  put_page(html, page);
}

}  // namespace

void add_check(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "check", "parse and check a model, and recordings with it; print the chain");
  auto common = std::make_shared<Common>();
  auto files = std::make_shared<std::pair<std::string, std::string>>();
  command->add_option("model", files->first, "model file (.xml or .lua)")->required();
  command->add_option("recordings", files->second, "recordings (.csv or .trc)");
  add_common(*command, *common, true, false);
  auto points = std::make_shared<std::string>();
  add_points(*command, *points);
  auto html = std::make_shared<std::string>();
  add_html(*command, *html);
  command->callback([=] { run(files->first, files->second, *points, *html, *common); });
}

}  // namespace talus
