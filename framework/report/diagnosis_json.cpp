#include <cmath>

#include "framework/calibration/load_columns.h"
#include "framework/report/diagnosis_report.h"
#include "framework/report/json_parts.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

Json value(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

Json json_of(const Curve& c) {
  Json out{{"x", c.x}, {"x_unit", c.x_unit}, {"y", c.y}, {"unit", c.y_unit}};
  out["points"] = Json::array();
  for (const CurvePoint& p : c.points)
    out["points"].push_back({{"x", value(p.x)},
                             {"before", value(p.before)},
                             {"after", value(p.after)},
                             {"fitted", value(p.fitted)},
                             {"std", value(p.std)},
                             {"count", p.count}});
  return out;
}

Json json_of(const Finding& f, const std::vector<Curve>& curves, std::size_t i) {
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
  out["statement"] = sentence_of(f);
  if (i < curves.size()) out["curve"] = json_of(curves[i]);
  return out;
}

Json json_of(const Suggestion& s, const std::string& file) {
  Json out{{"suggested", s.wins},
           {"statement", s.statement},
           {"expression", s.expression.empty() ? Json(nullptr) : Json(s.expression)},
           {"circumstance", s.circumstance}};
  out["parameters"] = Json::array();
  for (const ShownValue& v : s.values)
    out["parameters"].push_back(
        {{"name", v.name}, {"value", value(v.value)}, {"unit", v.unit}, {"std", value(v.std)}});
  out["odds"] = value(s.choice.odds);
  out["p_curve_beside"] = value(s.choice.beside_p);
  if (!s.choice.ranked.empty()) {
    out["chi2"] = value(s.choice.ranked[0].chi2);
    out["bic"] = value(s.choice.ranked[0].bic);
  }
  out["curve_chi2"] = value(s.choice.curve_chi2);
  out["curve_bic"] = value(s.choice.curve_bic);
  out["heldout_rms"] = s.wins ? value(s.fit.heldout_rms) : Json(nullptr);
  out["tried"] = Json::array();
  for (std::size_t i = 0; i < s.by.size() && i < 10; ++i)
    out["tried"].push_back({{"name", s.by[i].first}, {"odds", value(s.by[i].second)}});
  out["model"] = file.empty() ? Json(nullptr) : Json(file);
  return out;
}

Json json_of(const SeenSuspect& s) {
  return Json{{"effect", s.effect},
              {"location", s.location},
              {"smallest_visible", value(s.smallest)},
              {"unit", s.unit},
              {"of", s.amount},
              {"typical", value(s.typical)},
              {"visible_share", value(s.visible)},
              {"nearest_rival",
               s.rival.empty() ? Json(nullptr) : Json(s.rival + " at " + s.rival_location)},
              {"imitated", value(s.imitates)}};
}

Json poses_of(const NextRecordings& next, const Program& program) {
  Json out = Json::array();
  for (std::size_t k = 0; k < next.poses.size(); ++k) {
    Json pose;
    pose["readings"] = Json::object();
    for (std::size_t c = 0; c < next.names.size(); ++c) {
      if (!next.moves[c]) continue;
      const Unit unit = program.units.of(next.dimensions[c]);
      pose["readings"][next.names[c]] = {
          {"value", value(next.poses[k].coordinates[c] / unit.factor)}, {"unit", unit.text}};
    }
    for (const RecordedColumn& c : next.table.columns) {
      const double v = c.values[k] / c.unit.factor;
      if (c.name.starts_with("approach_")) pose["approach"][c.name.substr(9)] = value(v);
      for (const Payload& p : program.payloads)
        if (p.column == c.name)
          pose["payload"][c.name] = {{"value", value(v)}, {"unit", c.unit.text}};
    }
    if (const RecordedColumn* x = next.table.find(gravity_columns[0]);
        x && !std::isnan(x->values[k]))
      for (const char* name : gravity_columns)
        pose["gravity"].push_back(value(next.table.find(name)->values[k]));
    pose["how"] = next.poses[k].how;
    pose["again"] = value(next.poses[k].again);
    pose["gain"] = value(next.poses[k].gain);
    pose["for"] = "to " + join(next.poses[k].purposes, ", and to ");
    out.push_back(std::move(pose));
  }
  return out;
}

Json gain_of(const NextRecordings& next) {
  Json out{
      {"statement", next.statement}, {"before", value(next.before)}, {"after", value(next.after)}};
  out["targets"] = Json::array();
  for (const NextTarget& t : next.targets)
    out["targets"].push_back({{"effect", t.effect},
                              {"location", t.location},
                              {"of", t.amount},
                              {"unit", t.unit},
                              {"smallest_visible_before", value(t.smallest_before)},
                              {"smallest_visible_after", value(t.smallest_after)},
                              {"rivals", t.rivals},
                              {"told_apart_before", value(t.told_before)},
                              {"told_apart_after", value(t.told_after)},
                              {"attainable", t.attainable}});
  out["ranges_assumed"] = next.assumed;
  out["mounting"] = next.mounting.empty() ? Json(nullptr) : Json(next.mounting);
  return out;
}

}  // namespace

std::string diagnosis_json(const Diagnosis& d, const Advice& advice, const ReportContext& context,
                           const DiagnosisFiles& files) {
  const UnitSystem& units = d.program->units;
  Json out{{"talus", TALUS_VERSION},
           {"command", "diagnose"},
           {"model", context.model_file},
           {"recordings", context.recordings_file},
           {"poses", {{"fit", d.baseline.poses_fit}, {"check", d.baseline.poses_check}}},
           {"baseline", json_of(d.baseline, units)},
           {"verdict", to_string(d.verdict)},
           {"statement", sentence_of(d)}};
  out["findings"] = Json::array();
  for (std::size_t i = 0; i < d.findings.size(); ++i) {
    out["findings"].push_back(json_of(d.findings[i], advice.curves, i));
    if (i < advice.formulas.size() && advice.formulas[i])
      out["findings"].back()["formula"] = json_of(
          *advice.formulas[i], i < files.formula_models.size() ? files.formula_models[i] : "");
  }
  out["hints"] = Json::array();
  for (std::size_t i = 0; i < d.hints.size(); ++i)
    out["hints"].push_back(json_of(d.hints[i], advice.hint_curves, i));
  out["outliers"] = Json::array();
  for (const Outlier& o : d.outliers.found) out["outliers"].push_back(o.pose);
  out["outlier_statements"] = Json::array();
  for (const Outlier& o : d.outliers.found) out["outlier_statements"].push_back(o.statement);
  out["faults"] = Json::array();
  for (const Fault& f : d.faults) {
    out["faults"].push_back({{"kind", f.kind}, {"where", f.where}, {"statement", f.statement}});
    if (!f.poses.empty()) out["faults"].back()["poses"] = f.poses;
    if (f.note) out["faults"].back()["note"] = true;
  }
  if (d.clean) out["baseline_clean"] = json_of(*d.clean, units);
  out["noise"] = {{"scale", value(d.noise.scale)},
                  {"p_value", value(d.noise.p)},
                  {"kurtosis", value(d.noise.kurtosis)},
                  {"p_white", value(d.noise.p_white)},
                  {"correlation", value(d.noise.correlation)},
                  {"p_even", value(d.noise.p_even)},
                  {"statement", d.noise.statement}};
  out["sensitivity"] = Json::array();
  for (const SeenSuspect& s : advice.seen.suspects) out["sensitivity"].push_back(json_of(s));
  out["untestable"] = Json::array();
  for (const Untestable& u : advice.seen.untestable)
    out["untestable"].push_back(
        {{"effect", u.effect}, {"location", u.location}, {"lacks", u.lacks}});
  out["twins"] = Json::array();
  for (const std::vector<int>& group : advice.seen.twins) {
    Json names = Json::array();
    for (const int i : group) {
      const SeenSuspect& s = advice.seen.suspects[static_cast<std::size_t>(i)];
      names.push_back(s.effect + " at " + s.location);
    }
    out["twins"].push_back(std::move(names));
  }
  out["blind_spots"] = Json::array();
  for (const BlindSpot& b : advice.seen.blind)
    out["blind_spots"].push_back({{"name", b.name}, {"statement", b.statement}});
  out["heldout"] = {{"poses", d.heldout.poses},
                    {"before", value(d.heldout.before)},
                    {"after", value(d.heldout.after)},
                    {"after_95_percent", {value(d.heldout.after_low), value(d.heldout.after_high)}},
                    {"p_value", value(d.heldout.p_value)}};
  out["heldout"]["blocks"] = Json::array();
  for (const Block& b : d.blocks)
    out["heldout"]["blocks"].push_back({{"name", b.name},
                                        {"poses", b.poses},
                                        {"before", value(b.before)},
                                        {"after", value(b.after)}});
  out["after"] = json_of(d.after, d.program_after->units);
  out["extended_model"] = files.extended_model.empty() ? Json(nullptr) : Json(files.extended_model);
  out["next_poses"] = poses_of(advice.next, *d.program);
  out["next_poses_gain"] = gain_of(advice.next);
  out["seconds"] = d.seconds;
  return out.dump(1) + "\n";
}

}  // namespace talus
