#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/report/layout.h"
#include "framework/report/report.h"
#include "framework/report/verdict.h"

namespace talus {
namespace {

std::string measure_table(const std::vector<Measure>& list, const UnitSystem& units) {
  Table table({"<measure", "<unit", ">n", ".bias", ".precision", ".RMSE", ".FSR", ".% FSR"});
  for (const Measure& m : list) {
    const Unit unit = units.of(m.dimension);
    auto in = [&](double v) { return v / unit.factor; };
    // Bias and precision with the decimals of the RMSE that they make up.
    const double rmse = in(m.rmse);
    auto shown = [&](double v) {
      return std::isfinite(v) && rmse > 0 ? fixed(in(v), decimals_for(rmse / 100)) : figure(in(v));
    };
    table.row({m.name, unit.text, std::to_string(m.count), shown(m.bias), shown(m.precision),
               shown(m.rmse), figure(in(m.fsr)), figure(m.percent_fsr)});
  }
  return table.text();
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
  Table table({"<parameter", ".nominal", ".calibrated", ".difference", ".std", "<unit", "<"});
  for (std::size_t i = 0; i < std::min(most, list.size()); ++i) {
    const FittedValue& v = list[i];
    const Unit unit = units.of(v.dimension);
    const double std = v.std / unit.factor;
    const int d = decimals_for(std);
    table.row({v.name, fixed(v.nominal / unit.factor, std::min(d, 4)),
               fixed(v.value / unit.factor, d), fixed((v.value - v.nominal) / unit.factor, d),
               fixed(std, d), unit.text, v.identifiable ? "" : "not alone"});
  }
  std::string out = table.text();
  if (list.size() > most)
    out += fmt::format("  ... and {} more (see --json)\n", list.size() - most);
  if (std::any_of(list.begin(), list.end(), [](const FittedValue& v) { return !v.identifiable; }))
    out += wrapped(
        "not alone: seen only in combination with others, and so uncertain; see what is not seen.",
        "  ", "  ");
  return out;
}

std::string sweep_text(const std::vector<SweepStep>& sweep) {
  Table table({".weight", ".mean RMSE, %", ">iterations"});
  for (const SweepStep& s : sweep)
    table.row({fmt::format("{:.3f}", s.weight), fmt::format("{:.4f}", s.mean),
               std::to_string(s.iterations)});
  return "\nSweep of the first residual's weight\n" +
         wrapped(
             "RMSE of the rows held out in % of full-scale range, mean of all measures. As in "
             "the papers, the weight is chosen on the rows held out, so their errors are a "
             "little better than fresh rows would show.",
             "  ", "  ") +
         table.text() + fmt::format("  best: {:.3f}\n", sweep[best_of(sweep)].weight);
}

std::string fold_text(const std::vector<FoldStep>& folds) {
  Table table({">fold", ">poses held out", ".fitted", ".held out"});
  for (std::size_t i = 0; i < folds.size(); ++i)
    table.row({std::to_string(i + 1), std::to_string(folds[i].held_out),
               fmt::format("{:.4f}", folds[i].fit_rms),
               fmt::format("{:.4f}", folds[i].heldout_rms)});
  return fmt::format("\nEvery group held out once, in {} folds: residuals in sigmas\n",
                     folds.size()) +
         table.text() +
         fmt::format("  all folds: {:.4g} held out (root mean square)\n", all_folds(folds));
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

std::string unseen_text(const Identifiability& seen) {
  std::string out;
  for (const std::string& sentence : seen.unseen) out += wrapped(sentence, "  - ", "    ");
  return out;
}

std::string probing_text(const Program& program, const Measured& measured) {
  if (measured.shapes.empty()) return "";
  const Unit length_unit = program.units.of(length), angle_unit = program.units.of(angle);
  std::string out = wrapped(
      fmt::format("Probed shapes ({}), points of {}", length_unit.text, measured.points_file), "",
      "  ");
  Table table(
      {"<shape", "<kind", ">poses", ">points", ".RMSE", ".worst", ">(pose)", ".noise of a point"});
  for (const ShapeQuality& s : measured.shapes) {
    auto in = [&](double v) { return figure(v / length_unit.factor); };
    table.row({s.name, s.tag, std::to_string(s.poses), std::to_string(s.points), in(s.rmse),
               in(s.worst), fmt::format("{:g}", s.worst_pose), in(s.sigma)});
  }
  out += table.text();
  for (const DatumQuality& d : measured.datums)
    if (!std::isnan(d.worst))
      out += fmt::format("  datum {}: its shapes are square within {:.3g} {} (pose {:g})\n", d.name,
                         d.worst / angle_unit.factor, angle_unit.text, d.worst_pose);
  return out;
}

std::string text_report(const Program& program, const Fit& fit, const ReportContext& context) {
  const UnitSystem& units = program.units;
  std::string out = text_of(verdict_of_fit(program, fit));
  out += fmt::format("\n{}\n", program.name.empty() ? "Model" : program.name);
  out += wrapped(
      fmt::format("model {}, recordings {}: {} poses to fit, {} to check", context.model_file,
                  context.recordings_file, fit.poses_fit, fit.poses_check),
      "  ", "  ");
  if (context.measured && !context.measured->shapes.empty())
    out += "\n" + probing_text(program, *context.measured);
  out += "\nParameters\n" + parameter_table(fit.parameters, units, 200);
  if (!fit.shared.empty())
    out += "\nUnknowns shared by groups of rows\n" + parameter_table(fit.shared, units, 24);
  const Identifiability& s = fit.seen;
  if (!s.unseen.empty()) out += "\nWhat these recordings do not see\n" + unseen_text(s);
  if (!fit.measures_check.empty())
    out += "\nErrors on rows held out (measured minus modelled)\n" +
           measure_table(fit.measures_check, units) + distances(program, fit.measures_check);
  out += "\nErrors on fitted rows\n" + measure_table(fit.measures_fit, units) +
         distances(program, fit.measures_fit);
  if (fit.rows_missing)
    out +=
        fmt::format("  {} residuals were left out because a value is missing\n", fit.rows_missing);
  if (!context.sweep.empty()) out += sweep_text(context.sweep);
  if (!context.folds.empty()) out += fold_text(context.folds);
  out += "\nThe fit\n";
  out +=
      fmt::format("  observability indices O1 {:.3g}, O2 {:.3g}, O3 {:.3g}, O4 {:.3g}, O5 {:.3g}\n",
                  s.o1, s.o2, s.o3, s.o4, s.o5);
  return out + fmt::format("  {} iterations, {:.3g} s, {} ({})\n", fit.iterations, fit.seconds,
                           fit.stopped, fit.solver == "qr" ? "QR" : "normal equations");
}

}  // namespace talus
