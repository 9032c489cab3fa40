#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "framework/calibration/circumstances.h"
#include "framework/calibration/fit.h"
#include "framework/calibration/settings.h"
#include "framework/cli/commands.h"
#include "framework/cli/terminal.h"
#include "framework/kinematics/posture.h"
#include "framework/page/contents.h"
#include "framework/report/layout.h"
#include "framework/report/progress.h"
#include "framework/report/verdict.h"

namespace talus {
namespace {

// "300 ± 2" in two: the value and what stands behind it.
std::pair<std::string, std::string> parted(const std::string& quantity) {
  const std::size_t blank = quantity.find(' ');
  if (blank == std::string::npos) return {quantity, ""};
  return {quantity.substr(0, blank), quantity.substr(blank + 1)};
}

// A heading and its rows; nothing where there are none.
std::string part(const std::string& heading, const Table& table) {
  return table.empty() ? "" : "\n" + heading + "\n" + table.text();
}

std::string frames_text(const Program& program) {
  std::string out = "\nFrames\n";
  std::function<void(int, int)> branch = [&](int frame, int depth) {
    std::string names;
    for (const auto& [name, index] : program.frame_index)
      if (index == frame && name != program.frames[frame].name) names += " = " + name;
    out += fmt::format("  {:{}}{}{}\n", "", 2 * depth, program.frames[frame].name, names);
    for (std::size_t f = 0; f < program.frames.size(); ++f)
      if (program.frames[f].parent == frame) branch(static_cast<int>(f), depth + 1);
  };
  branch(0, 0);
  return out;
}

std::string circumstances_text(const Program& program) {
  std::vector<std::string> list;
  for (const Reading& r : program.readings)
    if (r.covariate) {  // the load of a joint has many columns
      const bool load = r.column.starts_with("load:");
      const std::string name =
          load ? "load of " + r.column.substr(5, r.column.find_last_of('.') - 5) : r.column;
      if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(name);
    }
  return list.empty() ? "" : "\nCircumstances\n" + wrapped(join(list), "  ", "  ");
}

std::string chain_text(const Program& program) {
  const UnitSystem& units = program.units;
  std::string out = frames_text(program);
  Table limbs({"<limb", ".length", ".width", ".height", "<unit", "<at"});
  for (const Limb& limb : program.limbs) {
    const Eigen::Vector3d size = limb.size / units.length.factor;
    limbs.row({limb.name, fmt::format("{:.4g}", size.x()), fmt::format("{:.4g}", size.y()),
               fmt::format("{:.4g}", size.z()), units.length.text,
               program.frames[limb.frame].name});
  }
  Table readings({"<sensor", "<column", "<joint coordinate, rad or mm"});
  for (const Reading& r : program.readings)
    if (!r.covariate) readings.row({r.sensor, r.column, formula(r.value, program.slot_names)});
  Table unknowns({"<unknown", "<one per"});
  for (const Unknown& u : program.unknowns)
    unknowns.row({u.name, u.per.empty() ? "pose" : join(u.per)});
  Table features({"<feature", "<kind", "<of", "<in"});
  for (const Feature& f : program.features)
    features.row({f.name, f.tag, program.chains[f.chain].at, program.chains[f.chain].in});
  Table rows({"<row", ".sigma", "<unit"});
  for (const Row& row : program.rows) {
    const Unit unit = units.of(row.dimension);
    rows.row({row.measure,
              row.sigma ? fmt::format("{:.4g}", *row.sigma / unit.factor) : "not stated",
              unit.text});
  }
  Table parameters({"<parameter", ".value", "<tolerance", "<unit"});
  for (const Parameter& p : program.parameters) {
    const auto [value, tolerance] = parted(write_quantity(p.nominal, p.dimension, units));
    parameters.row({p.name, value, tolerance, units.of(p.dimension).text});
  }
  return out + part("Limbs", limbs) + part("Readings", readings) + circumstances_text(program) +
         part("Unknowns", unknowns) + part("Measured features", features) +
         part("Residual rows", rows) + part("Free parameters", parameters);
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
  Table table({"<joints", ".angle, " + degrees.text, ".distance, " + mm.text});
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
    table.row({before->joint + " - " + axes[b].joint,
               fmt::format("{:.4g}", shown(acute) / degrees.factor),
               fmt::format("{:.4g}", shown(between.distance) / mm.factor)});
  }
  return part("Joint axes, readings at zero", table);
}

void run(const std::string& model_file, const std::string& recordings_file,
         const std::string& points_file, const std::string& html, const Common& common) {
  check_html(html, {model_file, recordings_file, points_file});
  Registry registry = common.registry();
  const Model model = open_model(model_file, registry, common);
  const Program program = compile(model, registry);
  PageContent page = page_content("check", model, common, {recordings_file, points_file});
  const std::string title = fmt::format("\n{}\n", program.name.empty() ? "Model" : program.name),
                    chain = chain_text(program) + axes_text(program);
  auto finish = [&](const Spoken& verdict, const std::string& more) {
    page.report_text =
        text_of(verdict) + title +
        wrapped("model " + model_file +
                    (recordings_file.empty() ? "" : ", recordings " + recordings_file),
                "  ", "  ") +
        more + chain;
    put_page(html, page);
    if (!common.quiet) show(page.report_text);
  };
  if (recordings_file.empty()) {
    page_of_model(page, program);
    return finish(verdict_of_model(program), "");
  }
  auto bar = std::make_unique<Progress>(!common.quiet, "checking");
  const Measured measured = open_recordings(program, recordings_file, points_file);
  const Recordings recordings = with_derived(program, measured.recordings);
  std::vector<std::size_t> rows(recordings.rows());
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = k;
  Problem problem(program, recordings, rows, Groups(program, recordings), {});
  const Identifiability seen = identify(problem, problem.start(), 1, program.units);
  const Spoken verdict = verdict_of_check(program, rows.size(), problem.data().missing(), seen);
  page_of_check(page, program, recordings, verdict, seen, problem.start());
  bar.reset();
  std::string more;
  if (!seen.unseen.empty())
    more += "\nWhat these recordings do not see, at the nominal values\n" + unseen_text(seen);
  if (!measured.shapes.empty()) more += "\n" + probing_text(program, measured);
  finish(verdict, more);
  for (const std::string& warning : measured.warnings) warn(warning);
}

}  // namespace

void add_check(CLI::App& app) {
  CLI::App* command =
      add_command(app, "check", "parse and check a model, and recordings with it; print the chain");
  auto common = std::make_shared<Common>();
  auto files = std::make_shared<std::pair<std::string, std::string>>();
  command->add_option("model", files->first, "model file (.xml or .lua)")->required();
  command->add_option("recordings", files->second, "recordings (.csv or .trc)");
  add_common(*command, *common, true, false);
  add_quiet(*command, *common);
  auto points = std::make_shared<std::string>();
  add_points(*command, *points);
  auto html = std::make_shared<std::string>();
  add_html(*command, *html);
  command->callback([=] { run(files->first, files->second, *points, *html, *common); });
}

}  // namespace talus
