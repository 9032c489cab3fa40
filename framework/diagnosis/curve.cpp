#include "framework/diagnosis/curve.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>

#include "framework/diagnosis/covariate_axes.h"
#include "framework/diagnosis/curve_place.h"

namespace talus {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

constexpr int kBins = 12;
constexpr int kFine = 48, kPosesInFine = 8;  // narrow bins: at most so many, of so many poses
const Unit kPlain{"1", number, 1, 0};

struct Corrections {
  VectorXd wanted, weight;  // per pose
  MatrixXd spread;          // of the effect's part in them, by independent directions of the noise
};

// Orthonormal directions of the rows along which the effect's amounts answer to the noise: their
// columns without what the other parameters take up. The priors' rows count.
MatrixXd answers(const Linearised& at, const Accepted& effect) {
  std::vector<int> own, others;
  for (std::size_t c = 0; c < at.parameters.size(); ++c)
    (is_amount(at, c, effect) ? own : others).push_back(static_cast<int>(c));
  auto basis = [](const MatrixXd& columns) -> MatrixXd {
    if (columns.cols() == 0) return columns;
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
    return qr.householderQ() * MatrixXd::Identity(columns.rows(), qr.rank());
  };
  const MatrixXd geometry = basis(at.baseline.columns(Eigen::all, others));
  MatrixXd amounts = at.baseline.columns(Eigen::all, own);
  amounts -= geometry * (geometry.transpose() * amounts);
  return basis(amounts);
}

Corrections corrections(const Linearised& at, const std::vector<int>& places, int part,
                        const MatrixXd& answers) {
  const auto poses = static_cast<Eigen::Index>(at.slots.size());
  Corrections c{VectorXd::Zero(poses), VectorXd::Zero(poses),
                MatrixXd::Zero(poses, answers.cols())};
  VectorXd f = VectorXd::Zero(at.columns.rows());
  for (const int p : places)
    f += at.columns.col(at.program->places[static_cast<std::size_t>(p)].first_field + part);
  for (Eigen::Index r = 0; r < f.size(); ++r) {
    const int k = at.baseline.pose[static_cast<std::size_t>(r)];
    c.wanted[k] -= f[r] * at.baseline.rows[r];
    c.weight[k] += f[r] * f[r];
    c.spread.row(k) += f[r] * answers.row(r);
  }
  for (Eigen::Index k = 0; k < poses; ++k) {
    const double w = c.weight[k] > 0 ? 1 / c.weight[k] : 0;
    c.wanted[k] *= w;
    c.spread.row(k) *= w;
  }
  return c;
}

// Which bin each value belongs to; -1: none. Bins of equal width, or of nearly equal counts.
std::vector<int> bins_of(const VectorXd& x, int most, bool counts) {
  std::map<double, int> distinct;  // how many
  for (const double v : x)
    if (std::isfinite(v)) ++distinct[v];
  std::vector<int> bins(static_cast<std::size_t>(x.size()), -1);
  if (distinct.size() < 2) return bins;
  const double low = distinct.begin()->first, high = distinct.rbegin()->first;
  const bool few = static_cast<int>(distinct.size()) <= most;
  std::map<double, int> bin;
  int before = 0, total = 0;
  for (const auto& [v, n] : distinct) total += n;
  for (const auto& [v, n] : distinct) {
    bin[v] = few      ? static_cast<int>(bin.size())
             : counts ? before * most / total
                      : std::min(most - 1, static_cast<int>(most * (v - low) / (high - low)));
    before += n;
  }
  for (Eigen::Index k = 0; k < x.size(); ++k)
    if (std::isfinite(x[k])) bins[static_cast<std::size_t>(k)] = bin[x[k]];
  return bins;
}

std::vector<CurvePoint> binned(const VectorXd& x, const Corrections& before,
                               const Corrections& after, int most, bool counts) {
  const std::vector<int> bins = bins_of(x, most, counts);
  std::vector<CurvePoint> points(static_cast<std::size_t>(most));
  std::vector<double> weights(points.size(), 0);
  MatrixXd spread = MatrixXd::Zero(most, after.spread.cols());
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const int bin = bins[static_cast<std::size_t>(k)];
    if (bin < 0 || !(before.weight[k] > 0)) continue;
    const auto b = static_cast<std::size_t>(bin);
    const double w = before.weight[k];
    points[b].x += x[k], points[b].count += 1;
    points[b].before += w * before.wanted[k], points[b].after += w * after.wanted[k];
    weights[b] += w;
    spread.row(bin) += w * after.spread.row(k);
  }
  std::vector<CurvePoint> result;
  for (std::size_t b = 0; b < points.size(); ++b) {
    CurvePoint p = points[b];
    if (p.count == 0) continue;
    p.x /= p.count, p.before /= weights[b], p.after /= weights[b];
    p.fitted = p.before - p.after;
    p.std = 1 / std::sqrt(weights[b]);
    p.fitted_std = spread.row(static_cast<Eigen::Index>(b)).norm() / weights[b];
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

  const MatrixXd directions = answers(after, e);
  const MatrixXd none(directions.rows(), 0);

  // The part of the correction that changed most between the fits.
  const int parts = parts_of(place.acts);
  Corrections first, second;
  double most = -1;
  int part = 0;
  for (int p = 0; p < parts; ++p) {
    const Corrections a = corrections(before, suspect->places, p, none),
                      b = corrections(after, then->places, p, directions);
    const double change = (a.wanted - b.wanted).cwiseAbs2().dot(a.weight);
    if (change > most) most = change, first = a, second = b, part = p;
  }
  double best = 0, factor = 1;
  for (const CovariateAxis& axis : covariate_axes(e, place, *before.program, units)) {
    const VectorXd x = values_at(before, axis.value);
    std::vector<CurvePoint> points = binned(x, first, second, kBins, false);
    if (shown(points) <= best) continue;
    best = shown(points);
    curve.x = axis.name, curve.x_unit = axis.unit, factor = axis.factor;
    curve.points = std::move(points);
    const int most = std::min(kFine, static_cast<int>(x.size()) / kPosesInFine);
    curve.fine = most > kBins ? binned(x, first, second, most, true) : curve.points;
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
  for (std::vector<CurvePoint>* points : {&curve.points, &curve.fine})
    for (CurvePoint& p : *points) {
      p.x /= factor;
      for (double* v : {&p.before, &p.after, &p.fitted, &p.std, &p.fitted_std}) *v /= unit.factor;
    }
  return curve;
}

}  // namespace talus
