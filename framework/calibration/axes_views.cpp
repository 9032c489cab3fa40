// In which frames axes are described, and how sure their numbers are.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/calibration/axes.h"

namespace talus {
namespace {

int main_direction(const Eigen::Vector3d& u) {
  int m = 0;
  u.cwiseAbs().maxCoeff(&m);
  return m;
}

// The feet of the shortest line between two lines: on the first, on the second.
std::pair<Eigen::Vector3d, Eigen::Vector3d> feet(const Line& a, const Line& b) {
  const Eigen::Vector3d across = b.point - a.point;
  const double c = a.direction.dot(b.direction), s2 = std::max(1e-300, 1 - c * c);
  const double s = (across.dot(a.direction) - c * across.dot(b.direction)) / s2,
               t = (c * across.dot(a.direction) - across.dot(b.direction)) / s2;
  return {a.point + s * a.direction, b.point + t * b.direction};
}

double wrapped(double angle) { return std::remainder(angle, 360 * deg); }

}  // namespace

std::vector<View> AxisFinder::body_views(const Located& reference) const {
  std::vector<View> views;
  for (std::size_t k = 0; k < hinges_.size(); ++k)
    views.push_back({Eigen::Isometry3d::Identity(),
                     main_direction(reference.axes[k].line.direction), body(hinges_[k])});
  return views;
}

std::vector<View> AxisFinder::anatomical_views(const Located& reference, const std::string& flexion,
                                               const std::vector<double>& zero,
                                               const Place& place) {
  if (hinges_.size() != 2)
    throw InputError(place, fmt::format("{} hinges", hinges_.size()),
                     "two hinges, to make anatomical frames from");
  const int f = hinge(flexion, place), other = 1 - f;
  for (const int k : {f, other})
    if (!reference.axes[k].determined)
      throw InputError(place,
                       fmt::format("axis '{}' is {}", hinges_[k].name, reference.axes[k].why),
                       "a reference motion that determines both axes");
  posture_.set(zero, reference.fit.x);
  auto line = [&](int k) {
    const JointAxis& a = posture_.axes()[hinges_[k].axis];
    return Line{a.point, hinges_[k].sense * a.direction};
  };
  const Line flexes = line(f), turns = line(other);
  Eigen::Vector3d i = flexes.direction.cross(turns.direction);
  if (i.norm() < 0.1)
    throw InputError(place, "the two axes are nearly parallel", "axes at least 6 deg apart");
  Eigen::Isometry3d view = Eigen::Isometry3d::Identity();  // T_root_Fa
  i.normalize();
  view.linear() << i, flexes.direction, i.cross(flexes.direction);
  view.translation() = feet(flexes, turns).first;
  std::vector<View> views(2);
  views[f] = {posture_.frame(hinges_[f].body).inverse() * view, 1, "F_a"};
  view.translation() -= 20 * view.linear().col(2);
  views[other] = {posture_.frame(hinges_[other].body).inverse() * view, 2, "T_a"};
  return views;
}

void AxisFinder::describe(Located& located, const std::vector<View>& views) {
  const Eigen::MatrixXd& C =
      located.observed ? located.covariance.observed : located.covariance.stated;
  const Eigen::MatrixXd& unbounded = located.covariance.unbounded;
  const std::size_t n = program_->parameters.size(), count = hinges_.size();
  // The numbers told, as a function of the parameters: four per axis, two per pair.
  auto numbers = [&](std::span<const double> x) {
    std::vector<double> out;
    const std::vector<Line> at_x = lines(x);
    for (std::size_t k = 0; k < count; ++k)
      for (double v : coordinates_of(at_x[k], views[k])) out.push_back(v);
    for (std::size_t k = 0; k + 1 < count; ++k) {
      const auto& axes = posture_.axes();
      JointAxis a = axes[hinges_[k].axis], b = axes[hinges_[k + 1].axis];
      a.direction *= hinges_[k].sense, b.direction *= hinges_[k + 1].sense;
      const Apart each = talus::apart(a, b);
      // With its sign, the distance can be differentiated where the lines meet.
      const double side = (b.point - a.point).dot(a.direction.cross(b.direction));
      out.push_back(each.angle);
      out.push_back(side < 0 ? -each.distance : each.distance);
    }
    return out;
  };
  std::vector<double> x(located.fit.x.begin(), located.fit.x.begin() + static_cast<long>(n));
  const std::vector<double> here = numbers(x);
  // Central differences over a small share of each parameter's own size.
  Eigen::MatrixXd G(static_cast<Eigen::Index>(here.size()), static_cast<Eigen::Index>(n));
  Eigen::VectorXd tolerance(static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i) {
    const Parameter& p = program_->parameters[i];
    tolerance[static_cast<Eigen::Index>(i)] =
        p.nominal.tolerance.value_or(std::numeric_limits<double>::infinity());
    const double step = p.dimension == angle    ? 1e-5
                        : p.dimension == length ? 1e-3
                                                : 1e-6,
                 middle = x[i];
    x[i] = middle + step;
    const std::vector<double> above = numbers(x);
    x[i] = middle - step;
    const std::vector<double> below = numbers(x);
    x[i] = middle;
    for (std::size_t r = 0; r < here.size(); ++r)
      G(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(i)) =
          (above[r] - below[r]) / (2 * step);
  }
  auto std_of = [&](Eigen::Index r) {
    // Nothing holds a direction that this number depends on.
    for (Eigen::Index c = 0; c < unbounded.cols(); ++c)
      if (std::abs(G.row(r).dot(unbounded.col(c))) > 1e-6 * G.row(r).norm())
        return std::numeric_limits<double>::infinity();
    return std::sqrt(std::max(0.0, (G.row(r) * C * G.row(r).transpose()).value()));
  };
  const UnitSystem& units = program_->units;
  for (std::size_t k = 0; k < count; ++k) {
    LocatedAxis& axis = located.axes[k];
    double kept = 0;  // the largest share of its tolerance that a number keeps
    for (std::size_t v = 0; v < 4; ++v) {
      const auto r = static_cast<Eigen::Index>(4 * k + v);
      axis.value[v] = here[4 * k + v];
      axis.std[v] = std_of(r);
      double before = 0;
      for (Eigen::Index i = 0; i < G.cols(); ++i)
        if (std::abs(G(r, i)) > 1e-9) before += std::pow(G(r, i) * tolerance[i], 2);
      if (before > 0) kept = std::max(kept, axis.std[v] / std::sqrt(before));
      if (std::isinf(axis.std[v])) kept = 1;
    }
    const auto column = located.coordinates.col(static_cast<Eigen::Index>(k));
    const double spread = std::sqrt((column.array() - column.mean()).square().mean());
    const double uncertain = std::max(axis.std[2], axis.std[3]);
    const Unit unit = units.angle;
    axis.determined = false;
    if (!(spread > 3 * axis.noise))
      axis.why = fmt::format(
          "not determined: the rotation about it spreads by only {:.2g} {u} (standard deviation), "
          "with an uncertainty of {:.2g} {u} in each pose",
          spread / unit.factor, axis.noise / unit.factor, fmt::arg("u", unit.text));
    else if (kept > 0.5 || uncertain > 30 * deg)
      axis.why = fmt::format(
          "not determined: this motion hardly narrows what the tolerances said (its direction is "
          "left uncertain by {})",
          std::isinf(uncertain) ? "any amount"
                                : fmt::format("{:.2g} {}", uncertain / unit.factor, unit.text));
    else
      axis.determined = true, axis.why.clear();
  }
  located.apart.clear();
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const auto r = static_cast<Eigen::Index>(4 * count + 2 * k);
    located.apart.push_back({static_cast<int>(k), static_cast<int>(k + 1),
                             std::abs(wrapped(here[r])), std_of(r), std::abs(here[r + 1]),
                             std_of(r + 1)});
  }
}

}  // namespace talus
