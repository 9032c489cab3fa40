#include "framework/diagnosis/curve.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "framework/diagnosis/covariate_axes.h"

namespace talus {
namespace {

using Eigen::VectorXd;

constexpr int kBins = 12;
const Unit kPlain{"1", number, 1, 0};

struct Corrections {
  VectorXd wanted, weight;  // per pose
};

Corrections corrections(const Linearised& at, const std::vector<int>& places, int part) {
  const auto poses = static_cast<Eigen::Index>(at.slots.size());
  Corrections c{VectorXd::Zero(poses), VectorXd::Zero(poses)};
  VectorXd f = VectorXd::Zero(at.columns.rows());
  for (const int p : places)
    f += at.columns.col(at.program->places[static_cast<std::size_t>(p)].first_field + part);
  for (Eigen::Index r = 0; r < f.size(); ++r) {
    const int k = at.baseline.pose[static_cast<std::size_t>(r)];
    c.wanted[k] -= f[r] * at.baseline.rows[r];
    c.weight[k] += f[r] * f[r];
  }
  for (Eigen::Index k = 0; k < poses; ++k)
    c.wanted[k] = c.weight[k] > 0 ? c.wanted[k] / c.weight[k] : 0;
  return c;
}

// Which bin each value belongs to; -1: none.
std::vector<int> bins_of(const VectorXd& x) {
  std::map<double, int> distinct;
  for (const double v : x)
    if (std::isfinite(v)) distinct[v] = 0;
  std::vector<int> bins(static_cast<std::size_t>(x.size()), -1);
  if (distinct.size() < 2) return bins;
  int next = 0;
  for (auto& [v, bin] : distinct) bin = next++;
  const double low = distinct.begin()->first, high = distinct.rbegin()->first;
  for (Eigen::Index k = 0; k < x.size(); ++k)
    if (std::isfinite(x[k]))
      bins[static_cast<std::size_t>(k)] =
          distinct.size() <= kBins
              ? distinct[x[k]]
              : std::min(kBins - 1, static_cast<int>(kBins * (x[k] - low) / (high - low)));
  return bins;
}

std::vector<CurvePoint> binned(const VectorXd& x, const Corrections& before,
                               const Corrections& after) {
  const std::vector<int> bins = bins_of(x);
  std::vector<CurvePoint> points(kBins);
  std::vector<double> weights(kBins, 0);
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const int bin = bins[static_cast<std::size_t>(k)];
    if (bin < 0 || !(before.weight[k] > 0)) continue;
    const auto b = static_cast<std::size_t>(bin);
    const double w = before.weight[k];
    points[b].x += x[k], points[b].count += 1;
    points[b].before += w * before.wanted[k], points[b].after += w * after.wanted[k];
    weights[b] += w;
  }
  std::vector<CurvePoint> result;
  for (std::size_t b = 0; b < points.size(); ++b) {
    CurvePoint p = points[b];
    if (p.count == 0) continue;
    p.x /= p.count, p.before /= weights[b], p.after /= weights[b];
    p.fitted = p.before - p.after;
    p.std = 1 / std::sqrt(weights[b]);
    result.push_back(p);
  }
  return result;
}

// How much of the change between the fits the bins show.
double shown(const std::vector<CurvePoint>& points) {
  double sum = 0;
  for (const CurvePoint& p : points) sum += std::pow(p.fitted / p.std, 2);
  return points.size() < 2 ? 0 : sum;
}

}  // namespace

Curve curve_of(const Ground& ground, const Search& search, std::size_t i, const UnitSystem& units) {
  const Accepted& e = search.best.effects.at(i);
  Trial without = search.null;
  if (search.best.effects.size() > 1) {
    std::vector<Accepted> rest = search.best.effects;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    without = fit_trial(ground, rest, search.best);
  }
  StageOptions options;
  options.suspects.only = {e.suspect.plugin->declaration.tag};
  const Linearised before = linearised(ground, without, options),
                   after = linearised(ground, search.best, options);
  const Suspect *suspect = suspect_of(before, e), *then = suspect_of(after, e);
  Curve curve;
  if (!suspect || !then || before.rows != after.rows) return curve;
  const EffectPlace& place = before.program->places[static_cast<std::size_t>(suspect->places[0])];

  // The part of the correction that changed most between the fits.
  const int parts = parts_of(place.acts);
  Corrections first, second;
  double most = -1;
  int part = 0;
  for (int p = 0; p < parts; ++p) {
    const Corrections a = corrections(before, suspect->places, p),
                      b = corrections(after, then->places, p);
    const double change = (a.wanted - b.wanted).cwiseAbs2().dot(a.weight);
    if (change > most) most = change, first = a, second = b, part = p;
  }
  double best = 0, factor = 1;
  for (const CovariateAxis& axis : covariate_axes(e, place, *before.program, units)) {
    std::vector<CurvePoint> points = binned(values_at(before, axis.value), first, second);
    if (shown(points) <= best) continue;
    best = shown(points);
    curve.x = axis.name, curve.x_unit = axis.unit, factor = axis.factor;
    curve.points = std::move(points);
  }
  const bool twist = parts == 6;
  const Unit unit = twist                         ? (part < 3 ? units.length : units.angle)
                    : parts == 9                  ? kPlain
                    : place.acts == Acts::lengths ? kPlain
                                                  : units.of(place.dimension);
  static constexpr const char* kTwist[] = {"shift along x", "shift along y", "shift along z",
                                           "turn about x",  "turn about y",  "turn about z"};
  curve.y = twist ? std::string(kTwist[part]) + " at " + e.suspect.location
                  : "correction of " + e.suspect.location;
  curve.y_unit = unit.text;
  for (CurvePoint& p : curve.points) {
    p.x /= factor;
    for (double* v : {&p.before, &p.after, &p.fitted, &p.std}) *v /= unit.factor;
  }
  return curve;
}

}  // namespace talus
