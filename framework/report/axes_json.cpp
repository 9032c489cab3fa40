#include <cmath>
#include <nlohmann/json.hpp>

#include "framework/report/axes.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

Json list(const Eigen::Vector3d& v, double factor = 1) {
  return {v[0] / factor, v[1] / factor, v[2] / factor};
}

class Writer {
 public:
  Writer(const AxisFinder& finder, const AxesResult& result, const AxesContext& context)
      : finder_(finder), result_(result), context_(context), units_(finder.program().units) {}

  Json located(const Located& l, std::size_t file) const {
    Json out{{"recordings", context_.recordings_files[file]},
             {"poses", l.fit.poses_fit},
             {"fit_rms", number_or_null(l.fit.fit_rms)},
             {"expected_rms", number_or_null(l.fit.expected_rms)},
             {"noise_known", l.fit.noise_known},
             {"noise_scale", number_or_null(l.fit.noise_scale)},
             {"chi2", number_or_null(l.fit.chi2)},
             {"dof", number_or_null(l.fit.dof)},
             {"p_value", number_or_null(l.fit.chi2_p)},
             {"converged", l.fit.converged},
             {"uncertainties", l.observed ? "observed" : "stated"},
             {"warnings", l.fit.warnings},
             {"axes", Json::array()},
             {"apart", Json::array()}};
    for (std::size_t k = 0; k < l.axes.size(); ++k) {
      const LocatedAxis& a = l.axes[k];
      const Hinge& h = finder_.hinges()[k];
      const View& view = result_.views[k];
      const double turn = units_.angle.factor;
      Json axis{{"name", h.name},
                {"coordinate", h.coordinate},
                {"body", finder_.body(h)},
                {"still", h.still},
                {"range", {a.low / turn, a.high / turn}},
                {"coordinate_std", number_or_null(a.noise / turn)},
                {"determined", a.determined}};
      if (a.determined) {
        axis["point"] = list(a.line.point, units_.length.factor);
        axis["direction"] = list(a.line.direction);
        axis["view"] = view.name;
        axis["main"] = context_.labels.along[view.main];
        axis["variables"] = variables(k, a.value, a.std);
      } else {
        axis["why"] = a.why;
      }
      out["axes"].push_back(std::move(axis));
    }
    for (const Apartness& p : l.apart)
      if (l.axes[p.first].determined && l.axes[p.second].determined)
        out["apart"].push_back(
            {{"axes", {finder_.hinges()[p.first].name, finder_.hinges()[p.second].name}},
             {"angle", p.angle / units_.angle.factor},
             {"angle_std", number_or_null(p.angle_std / units_.angle.factor)},
             {"distance", p.distance / units_.length.factor},
             {"distance_std", number_or_null(p.distance_std / units_.length.factor)}});
    return out;
  }

  Json arc(const ArcAxes& of) const {
    Json out{{"arc", nullptr}, {"by_recording", Json::array()}, {"changes", Json::array()}};
    if (of.arc)
      out["arc"] = {of.arc->first / units_.angle.factor, of.arc->last / units_.angle.factor};
    for (std::size_t r = 0; r < of.located.size(); ++r)
      out["by_recording"].push_back(located(of.located[r], r));
    for (std::size_t r = 0; r < of.changes.size(); ++r) {
      Json change{{"recordings", context_.recordings_files[r + 1]}, {"axes", Json::array()}};
      for (std::size_t k = 0; k < of.changes[r].size(); ++k) {
        const AxisChange& c = of.changes[r][k];
        Json axis{{"name", finder_.hinges()[k].name}, {"determined", c.determined}};
        if (c.determined) axis["variables"] = variables(k, c.value, c.std);
        change["axes"].push_back(std::move(axis));
      }
      out["changes"].push_back(std::move(change));
    }
    for (const ChangeErrors& e : of.errors) out["errors"].push_back(errors(e));
    return out;
  }

  Json errors(const ChangeErrors& e) const {
    const Unit u = unit(e.variable);
    return {{"name", variable_name(finder_, result_, context_.labels, e.axis, e.variable)},
            {"unit", u.text},
            {"count", e.count},
            {"bias", number_or_null(e.bias / u.factor)},
            {"precision", number_or_null(e.precision / u.factor)},
            {"rmse", number_or_null(e.rmse / u.factor)}};
  }

 private:
  Unit unit(int variable) const { return variable < 2 ? units_.length : units_.angle; }

  Json variables(std::size_t k, const std::array<double, 4>& value,
                 const std::array<double, 4>& std) const {
    Json out = Json::array();
    for (int v = 0; v < 4; ++v)
      out.push_back(
          {{"name", variable_name(finder_, result_, context_.labels, static_cast<int>(k), v)},
           {"unit", unit(v).text},
           {"value", value[v] / unit(v).factor},
           {"std", number_or_null(std[v] / unit(v).factor)}});
    return out;
  }

  const AxisFinder& finder_;
  const AxesResult& result_;
  const AxesContext& context_;
  const UnitSystem& units_;
};

}  // namespace

std::string axes_json(const AxisFinder& finder, const AxesResult& result,
                      const AxesContext& context) {
  const Writer writer(finder, result, context);
  Json out{{"talus", TALUS_VERSION},
           {"command", "axes"},
           {"model", context.model_file},
           {"linkage", context.linkage_file.empty() ? Json(nullptr) : Json(context.linkage_file)},
           {"recordings", context.recordings_files},
           {"whole", writer.arc(result.whole)},
           {"arcs", Json::array()}};
  for (const ArcAxes& arc : result.arcs) out["arcs"].push_back(writer.arc(arc));
  for (const auto& [arc, e] : result.worst) {
    Json worst = writer.errors(e);
    worst["arc"] = arc < 0 ? Json(nullptr) : Json(result.arcs[arc].arc->name);
    out["worst"].push_back(std::move(worst));
  }
  return out.dump(1) + "\n";
}

}  // namespace talus
