#include <cmath>

#include "framework/report/diagnosis_report.h"
#include "framework/report/json_parts.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

Json value(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

Json json_of(const Finding& f) {
  Json out{{"effect", f.effect}, {"location", f.location}, {"probability", value(f.probability)}};
  if (!f.driver.empty()) out["driver"] = f.driver;
  out["parameters"] = Json::array();
  for (const ShownValue& v : f.parameters)
    out["parameters"].push_back(
        {{"name", v.name}, {"value", value(v.value)}, {"unit", v.unit}, {"std", value(v.std)}});
  out["evidence"] = {{"delta_chi2", value(f.delta_chi2)},
                     {"delta_bic", value(f.delta_bic)},
                     {"p_value", value(f.p_value)},
                     {"sigmas_per_pose", value(f.sigmas)},
                     {"heldout_rms_before", value(f.heldout_before)},
                     {"heldout_rms_after", value(f.heldout_after)}};
  out["rivals"] = Json::array();
  for (const NamedRival& r : f.rivals)
    out["rivals"].push_back(
        {{"effect", r.effect}, {"location", r.location}, {"probability", r.probability}});
  out["statement"] = f.statement;
  return out;
}

}  // namespace

std::string diagnosis_json(const Diagnosis& d, const ReportContext& context,
                           const std::string& extended_model) {
  const UnitSystem& units = d.program->units;
  Json out{{"talus", TALUS_VERSION},
           {"command", "diagnose"},
           {"model", context.model_file},
           {"recordings", context.recordings_file},
           {"poses", {{"fit", d.baseline.poses_fit}, {"check", d.baseline.poses_check}}},
           {"baseline", json_of(d.baseline, units)},
           {"verdict", to_string(d.verdict)},
           {"statement", d.statement}};
  out["findings"] = Json::array();
  for (const Finding& f : d.findings) out["findings"].push_back(json_of(f));
  out["hints"] = Json::array();
  for (const Finding& f : d.hints) out["hints"].push_back(json_of(f));
  out["outliers"] = Json::array();
  for (const Outlier& o : d.outliers.found) out["outliers"].push_back(o.pose);
  out["faults"] = Json::array();
  for (const Fault& f : d.faults)
    out["faults"].push_back(
        {{"kind", f.kind}, {"where", f.where}, {"statement", f.statement}, {"poses", f.poses}});
  if (d.clean) out["baseline_clean"] = json_of(*d.clean, units);
  out["sensitivity"] = Json::array();
  out["heldout"] = {{"poses", d.heldout.poses},
                    {"before", value(d.heldout.before)},
                    {"after", value(d.heldout.after)},
                    {"after_95_percent", {value(d.heldout.after_low), value(d.heldout.after_high)}},
                    {"p_value", value(d.heldout.p_value)}};
  out["after"] = json_of(d.after, d.program_after->units);
  out["extended_model"] = extended_model.empty() ? Json(nullptr) : Json(extended_model);
  out["next_poses"] = Json::array();
  out["seconds"] = d.seconds;
  return out.dump(1) + "\n";
}

}  // namespace talus
