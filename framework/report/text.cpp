#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/report/report.h"

namespace talus {
namespace {

std::string cell(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals)
                              : std::string(std::isnan(value) ? "-" : "unseen");
}

// Four significant digits, without exponents where they are not needed.
std::string figure(double value) {
  if (!std::isfinite(value)) return "-";
  if (value == 0) return "0";
  const int decimals =
      std::clamp(3 - static_cast<int>(std::floor(std::log10(std::abs(value)))), 0, 9);
  return fmt::format("{:.{}f}", value, std::min(decimals, 7));
}

// Decimals that show the uncertainty with two digits, within reason.
int decimals_for(double std) {
  if (!(std > 0) || !std::isfinite(std)) return 4;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(std))), 0, 7);
}

std::string measure_table(const std::vector<Measure>& list, const UnitSystem& units) {
  std::size_t width = 7;
  for (const Measure& m : list) width = std::max(width, m.name.size());
  std::string out =
      fmt::format("  {:<{}}  {:<6} {:>5} {:>11} {:>11} {:>11} {:>10} {:>8}\n", "measure", width,
                  "unit", "n", "bias", "precision", "RMSE", "FSR", "% FSR");
  for (const Measure& m : list) {
    const Unit unit = units.of(m.dimension);
    auto in = [&](double v) { return v / unit.factor; };
    out += fmt::format("  {:<{}}  {:<6} {:>5} {:>11} {:>11} {:>11} {:>10} {:>8}\n", m.name, width,
                       unit.text, m.count, figure(in(m.bias)), figure(in(m.precision)),
                       figure(in(m.rmse)), figure(in(m.fsr)), figure(m.percent_fsr));
  }
  return out;
}

// Root mean square of the distance in space, where a feature has x, y and z in one unit of length.
std::string distances(const Program& program, const std::vector<Measure>& list) {
  std::string out;
  for (std::size_t i = 0; i + 2 < list.size(); ++i) {
    if (list[i].count == 0 || !(list[i].dimension == length) || !list[i].name.ends_with(".x") ||
        !list[i + 2].name.ends_with(".z"))
      continue;
    double sum = 0;
    for (std::size_t k = i; k < i + 3; ++k) sum += list[k].rmse * list[k].rmse;
    const Unit unit = program.units.of(length);
    out += fmt::format("  {}: {:.4g} {} in space (root mean square)\n",
                       list[i].name.substr(0, list[i].name.size() - 2),
                       std::sqrt(sum) / unit.factor, unit.text);
  }
  return out;
}

std::string parameter_table(std::vector<FittedValue> list, const UnitSystem& units,
                            std::size_t most) {
  std::erase_if(list, [](const FittedValue& v) { return v.held_out; });
  std::size_t width = 9;
  for (const FittedValue& v : list) width = std::max(width, v.name.size());
  std::string out = fmt::format("  {:<{}} {:>13} {:>13} {:>13} {:>12}  {}\n", "parameter", width,
                                "nominal", "calibrated", "difference", "std", "unit");
  for (std::size_t i = 0; i < std::min(most, list.size()); ++i) {
    const FittedValue& v = list[i];
    const Unit unit = units.of(v.dimension);
    const double std = v.std / unit.factor;
    const int d = decimals_for(std);
    out += fmt::format("  {:<{}} {:>13} {:>13} {:>13} {:>12}  {}{}\n", v.name, width,
                       cell(v.nominal / unit.factor, std::min(d, 4)),
                       cell(v.value / unit.factor, d), cell((v.value - v.nominal) / unit.factor, d),
                       cell(std, d), unit.text, v.identifiable ? "" : "   not identifiable alone");
  }
  if (list.size() > most)
    out += fmt::format("  ... and {} more (see --json)\n", list.size() - most);
  return out;
}

std::string sweep_text(const std::vector<SweepStep>& sweep) {
  std::string out =
      "\nSweep of the first residual's weight (RMSE of the check rows in % of full-scale range). "
      "As in the papers, the weight is\n"
      "chosen on the rows held out, so their errors above are a little better than fresh rows "
      "would show.\n";
  for (const SweepStep& s : sweep)
    out += fmt::format("  weight {:.3f}: mean {:.4f} %, {} iterations\n", s.weight, s.mean,
                       s.iterations);
  return out + fmt::format("  best: {:.3f}\n", sweep[best_of(sweep)].weight);
}

std::string fold_text(const std::vector<FoldStep>& folds) {
  std::string out = fmt::format("\nHeld out by {} folds of whole groups\n", folds.size());
  for (std::size_t i = 0; i < folds.size(); ++i)
    out += fmt::format("  fold {}: {} poses held out, residuals {:.4g} fitted, {:.4g} held out\n",
                       i + 1, folds[i].held_out, folds[i].fit_rms, folds[i].heldout_rms);
  return out + fmt::format("  all folds: {:.4g} held out (root mean square)\n", all_folds(folds));
}

}  // namespace

std::size_t best_of(const std::vector<SweepStep>& sweep) {
  const auto it = std::min_element(sweep.begin(), sweep.end(),
                                   [](auto& a, auto& b) { return a.mean < b.mean; });
  return static_cast<std::size_t>(it - sweep.begin());
}

double all_folds(const std::vector<FoldStep>& folds) {
  double sum = 0, poses = 0;
  for (const FoldStep& f : folds) {
    sum += f.heldout_rms * f.heldout_rms * static_cast<double>(f.held_out);
    poses += static_cast<double>(f.held_out);
  }
  return std::sqrt(sum / std::max(1.0, poses));
}

std::string probing_text(const Program& program, const Measured& measured) {
  if (measured.shapes.empty()) return "";
  const Unit length_unit = program.units.of(length), angle_unit = program.units.of(angle);
  std::size_t width = 5;
  for (const ShapeQuality& s : measured.shapes) width = std::max(width, s.name.size());
  std::string out = fmt::format(
      "Probed shapes ({}), points of {}\n  {:<{}}  {:<8} {:>6} {:>7} {:>9} {:>9} {:>6} {:>14}\n",
      length_unit.text, measured.points_file, "shape", width, "kind", "poses", "points", "RMSE",
      "worst", "(pose)", "noise of a point");
  for (const ShapeQuality& s : measured.shapes) {
    auto in = [&](double v) { return figure(v / length_unit.factor); };
    out += fmt::format("  {:<{}}  {:<8} {:>6} {:>7} {:>9} {:>9} {:>6} {:>14}\n", s.name, width,
                       s.tag, s.poses, s.points, in(s.rmse), in(s.worst),
                       fmt::format("{:g}", s.worst_pose), in(s.sigma));
  }
  for (const DatumQuality& d : measured.datums)
    if (!std::isnan(d.worst))
      out += fmt::format("  datum {}: its shapes are square within {:.3g} {} (pose {:g})\n", d.name,
                         d.worst / angle_unit.factor, angle_unit.text, d.worst_pose);
  return out;
}

std::string text_report(const Program& program, const Fit& fit, const ReportContext& context) {
  const UnitSystem& units = program.units;
  std::string out =
      fmt::format("{}\n  model {}, recordings {}: {} poses to fit, {} to check\n\n", program.name,
                  context.model_file, context.recordings_file, fit.poses_fit, fit.poses_check);
  if (context.measured && !context.measured->shapes.empty())
    out += probing_text(program, *context.measured) + "\n";
  out += "Parameters\n" + parameter_table(fit.parameters, units, 200);
  if (!fit.shared.empty())
    out += "\nUnknowns shared by groups of rows\n" + parameter_table(fit.shared, units, 24);
  if (!fit.measures_check.empty())
    out += "\nErrors on rows held out (measured minus modelled)\n" +
           measure_table(fit.measures_check, units) + distances(program, fit.measures_check);
  out += "\nErrors on fitted rows\n" + measure_table(fit.measures_fit, units) +
         distances(program, fit.measures_fit);
  if (fit.rows_missing)
    out +=
        fmt::format("  {} residuals were left out because a value is missing\n", fit.rows_missing);
  const char* divisor = fit.noise_known ? "stated sigmas" : "noise estimated from the fit";
  out += fmt::format(
      "\nResiduals in {}: {} fitted, {} held out ({:.3g} = explained by the instruments)\n",
      divisor, figure(fit.fit_rms), figure(fit.heldout_rms), fit.expected_rms);
  if (fit.noise_known)
    out += fmt::format("Chi-square {:.5g} on {:.0f} degrees of freedom, p = {:.2g}\n", fit.chi2,
                       fit.dof, fit.chi2_p);
  const Identifiability& s = fit.seen;
  out += fmt::format("Identifiability: {} of {} directions seen", s.seen, s.singular.size());
  out += s.unseen.empty() ? "\n" : "; unseen:\n";
  for (const std::string& sentence : s.unseen) out += "  - " + sentence + "\n";
  out +=
      fmt::format("Observability indices O1 {:.3g}, O2 {:.3g}, O3 {:.3g}, O4 {:.3g}, O5 {:.3g}\n",
                  s.o1, s.o2, s.o3, s.o4, s.o5);
  out += fmt::format("{} iterations, {:.3g} s, {} ({})\n", fit.iterations, fit.seconds, fit.stopped,
                     fit.solver == "qr" ? "QR" : "normal equations");
  for (const std::string& warning : fit.warnings) out += "Warning: " + warning + "\n";
  if (!context.sweep.empty()) out += sweep_text(context.sweep);
  if (!context.folds.empty()) out += fold_text(context.folds);
  return out;
}

}  // namespace talus
