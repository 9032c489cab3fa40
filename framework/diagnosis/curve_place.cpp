#include "framework/diagnosis/curve_place.h"

#include <algorithm>

#include "framework/diagnosis/screen_inside.h"

namespace talus {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr int kCells = 3000;

// The effect with one of its amounts at one, as a function of the circumstances.
std::vector<Expr> act_of(const Suspect& suspect, const Way& way, const EffectPlace& place,
                         const std::string& amount) {
  std::vector<Expr> inputs;
  for (const Input& i : suspect.plugin->declaration.inputs)
    if (i.role == Role::amount)
      inputs.emplace_back(i.name == amount ? 1 : 0);
    else if (i.role == Role::borrowed)
      inputs.push_back(place.inputs.at(i.name));
    else
      inputs.emplace_back(way.settings.contains(i.name) ? way.settings.at(i.name) : i.otherwise);
  return suspect.plugin->act(place.around, inputs, way.choices);
}

// The part of the correction that the curve is; -1 where it is several.
int part_of(const Accepted& e, const EffectPlace& place) {
  int part = -1;
  const std::vector<Expr> u = act_of(e.suspect, e.way, place, e.way.amounts.at(0));
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (u[i].is_constant()) continue;
    if (part >= 0) return -1;
    part = static_cast<int>(i);
  }
  return part;
}

// The columns of the effect's own amounts, and their priors' rows.
void take_out(Linearised& at, const Accepted& e) {
  Baseline& base = at.baseline;
  std::vector<int> columns, rows, pose;
  std::vector<bool> drop(static_cast<std::size_t>(base.rows.size()), false);
  for (std::size_t c = 0; c < at.parameters.size(); ++c) {
    const auto column = static_cast<Index>(c);
    if (!is_amount(at, c, e)) {
      columns.push_back(static_cast<int>(c));
      continue;
    }
    for (Index r = 0; r < base.rows.size(); ++r)
      if (base.pose[static_cast<std::size_t>(r)] < 0 && base.columns(r, column) != 0)
        drop[static_cast<std::size_t>(r)] = true;
  }
  for (std::size_t r = 0; r < drop.size(); ++r)
    if (!drop[r]) rows.push_back(static_cast<int>(r)), pose.push_back(base.pose[r]);
  base.rows = VectorXd(base.rows(rows));
  base.columns = MatrixXd(base.columns(rows, columns));
  base.pose = std::move(pose);
}

}  // namespace

bool is_amount(const Linearised& at, std::size_t parameter, const Accepted& effect) {
  const auto p = static_cast<std::size_t>(at.parameters[parameter]);
  return p < at.program->parameters.size() &&
         at.program->parameters[p].element ==
             effect.suspect.plugin->declaration.tag + "_" + effect.suspect.at;
}

std::optional<CurvePlace> curve_place(const Ground& ground, const Search& search, std::size_t i,
                                      const UnitSystem& units) {
  // Linear where the fit with the curve ended; the curve is then taken out of the rows.
  const Accepted& e = search.best.effects.at(i);
  StageOptions options;
  options.suspects.only = {e.suspect.plugin->declaration.tag};
  Linearised at = linearised(ground, search.best, options);
  const Suspect* suspect = suspect_of(at, e);
  if (!suspect) return {};
  const EffectPlace& place = at.program->places[static_cast<std::size_t>(suspect->places[0])];
  const std::vector<CovariateAxis> axes = covariate_axes(e, place, *at.program, units);
  if (axes.size() != 1 || suspect->places.size() != 1) return {};
  CurvePlace r{axes[0], part_of(e, place), {}, place.dimension};
  if (r.part < 0) return {};
  if (parts_of(place.acts) == 6) r.corrects = r.part < 3 ? length : angle;
  CurveEvidence& c = r.evidence;
  c.of = r.axis.dimension;
  c.x = values_at(at, r.axis.value);
  if (!c.x.allFinite() || !(c.x.maxCoeff() > c.x.minCoeff())) return {};
  for (std::size_t w = 0; w < at.suspects.ways.size(); ++w) {
    const Way& way = at.suspects.ways[w];
    if (&at.suspects.suspects[static_cast<std::size_t>(way.suspect)] != suspect ||
        way.choices != e.way.choices)
      continue;
    MatrixXd pieces(c.x.size(), static_cast<Index>(way.amounts.size()));
    for (std::size_t a = 0; a < way.amounts.size(); ++a)
      pieces.col(static_cast<Index>(a)) = values_at(
          at, act_of(*suspect, way, place, way.amounts[a])[static_cast<std::size_t>(r.part)]);
    c.curves.push_back(std::move(pieces));
    c.typical = way.typical.at(0);
  }
  VectorXd curve = VectorXd::Zero(c.x.size());
  for (std::size_t a = 0; a < e.way.amounts.size(); ++a)
    curve +=
        e.amounts[a] * values_at(at, act_of(*suspect, e.way, place,
                                            e.way.amounts[a])[static_cast<std::size_t>(r.part)]);
  const VectorXd f = at.columns.col(place.first_field + r.part);
  for (Index k = 0; k < f.size(); ++k)
    at.baseline.rows[k] -= f[k] * curve[at.baseline.pose[static_cast<std::size_t>(k)]];
  take_out(at, e);
  Candidates none;
  none.columns.resize(f.size(), 0);
  const Screen screen(std::move(at.baseline), std::move(none));
  const Screen::Inside& in = screen.inside();
  c.weight = c.wanted = VectorXd::Zero(c.x.size());
  c.absorbed = MatrixXd::Zero(in.Q.cols(), c.x.size());
  for (std::size_t s = 0; s < in.order.size(); ++s) {
    const int k = in.pose[s];
    const double column = f[in.order[s]];
    c.weight[k] += column * column;
    c.wanted[k] -= column * in.rest[static_cast<Index>(s)];
    c.absorbed.col(k) += column * in.Q.row(static_cast<Index>(s)).transpose();
  }
  c.chi2 = screen.chi2(), c.freedom = screen.freedom();
  c.rows = static_cast<double>(in.order.size());
  c.noise_known = in.noise_known;
  c = in_cells(c, kCells);
  return r;
}

}  // namespace talus
