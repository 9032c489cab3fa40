#include <cmath>
#include <nlohmann/json.hpp>

#include "framework/report/json_parts.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

Json value(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

Json list(const std::vector<Measure>& measures, const UnitSystem& units) {
  Json out = Json::array();
  for (const Measure& m : measures) {
    const Unit unit = units.of(m.dimension);
    out.push_back({{"name", m.name},
                   {"unit", unit.text},
                   {"count", m.count},
                   {"bias", value(m.bias / unit.factor)},
                   {"precision", value(m.precision / unit.factor)},
                   {"rmse", value(m.rmse / unit.factor)},
                   {"fsr", value(m.fsr / unit.factor)},
                   {"percent_fsr", value(m.percent_fsr)}});
  }
  return out;
}

Json list(const std::vector<FittedValue>& values, const UnitSystem& units) {
  Json out = Json::array();
  for (const FittedValue& v : values) {
    const Unit unit = units.of(v.dimension);
    out.push_back({{"name", v.name},
                   {"unit", unit.text},
                   {"nominal", v.nominal / unit.factor},
                   {"value", v.value / unit.factor},
                   {"difference", (v.value - v.nominal) / unit.factor},
                   {"std", value(v.std / unit.factor)},
                   {"tolerance", v.tolerance ? Json(*v.tolerance / unit.factor) : Json(nullptr)},
                   {"identifiable", v.identifiable},
                   {"at_bound", v.at_bound},
                   {"held_out", v.held_out}});
  }
  return out;
}

Json probed(const Measured& measured, const UnitSystem& units) {
  const double mm = units.of(length).factor, rad = units.of(angle).factor;
  Json out{{"points", measured.points_file},
           {"unit", units.of(length).text},
           {"angle_unit", units.of(angle).text}};
  for (const ShapeQuality& s : measured.shapes)
    out["shapes"].push_back({{"name", s.name},
                             {"shape", s.tag},
                             {"poses", s.poses},
                             {"points", s.points},
                             {"rmse", value(s.rmse / mm)},
                             {"worst", value(s.worst / mm)},
                             {"worst_pose", s.worst_pose},
                             {"sigma", value(s.sigma / mm)}});
  for (const DatumQuality& d : measured.datums)
    out["datums"].push_back(
        {{"name", d.name}, {"square_within", value(d.worst / rad)}, {"worst_pose", d.worst_pose}});
  return out;
}

}  // namespace

nlohmann::ordered_json json_of(const Fit& fit, const UnitSystem& units) {
  return Json{{"fit_rms", value(fit.fit_rms)},
              {"heldout_rms", value(fit.heldout_rms)},
              {"expected_rms", value(fit.expected_rms)},
              {"chi2", value(fit.chi2)},
              {"dof", value(fit.dof)},
              {"chi2_dof", value(fit.chi2 / fit.dof)},
              {"p_value", value(fit.chi2_p)},
              {"noise_known", fit.noise_known},
              {"noise_scale", value(fit.noise_scale)},
              {"measures", list(fit.measures_check, units)},
              {"measures_fit", list(fit.measures_fit, units)},
              {"parameters", list(fit.parameters, units)},
              {"shared", list(fit.shared, units)},
              {"unidentifiable", fit.seen.unseen},
              {"directions_seen", fit.seen.seen},
              {"directions", fit.seen.singular.size()},
              {"observability",
               {{"O1", value(fit.seen.o1)},
                {"O2", value(fit.seen.o2)},
                {"O3", value(fit.seen.o3)},
                {"O4", value(fit.seen.o4)},
                {"O5", value(fit.seen.o5)}}},
              {"missing", fit.rows_missing},
              {"cost", value(fit.cost)},
              {"iterations", fit.iterations},
              {"seconds", fit.seconds},
              {"converged", fit.converged},
              {"stopped", fit.stopped},
              {"solver", fit.solver},
              {"warnings", fit.warnings}};
}

std::string json_report(const Program& program, const Fit& fit, const ReportContext& context) {
  const UnitSystem& units = program.units;
  Json out{{"talus", TALUS_VERSION},
           {"command", context.command},
           {"model", context.model_file},
           {"recordings", context.recordings_file},
           {"poses",
            {{"fit", fit.poses_fit},
             {"check", fit.poses_check},
             {"check_rows", fit.residuals_check.poses}}},
           {"baseline", json_of(fit, units)}};
  if (context.measured && !context.measured->shapes.empty())
    out["probed"] = probed(*context.measured, units);
  if (!context.sweep.empty()) {
    Json& sweep = out["sweep"];
    sweep["best"] = context.sweep[best_of(context.sweep)].weight;
    for (const SweepStep& s : context.sweep)
      sweep["steps"].push_back({{"weight", s.weight},
                                {"mean_percent_fsr", s.mean},
                                {"iterations", s.iterations},
                                {"measures", list(s.measures, units)}});
  }
  if (!context.folds.empty()) {
    Json& folds = out["folds"];
    folds["heldout_rms"] = all_folds(context.folds);
    for (const FoldStep& f : context.folds)
      folds["steps"].push_back({{"held_out", f.held_out},
                                {"fit_rms", value(f.fit_rms)},
                                {"heldout_rms", value(f.heldout_rms)}});
  }
  return out.dump(1) + "\n";
}

}  // namespace talus
