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

// Four numbers per axis, then angle and distance (with a sign, so that it has a derivative where
// the lines meet) per pair, all at zero coordinates; exact derivatives by the parameters.
std::pair<std::vector<double>, Eigen::MatrixXd> AxisFinder::numbers(
    const std::vector<double>& x, const std::vector<View>& views) {
  using Traced = Posture::TracedLine;
  posture_.set(std::vector<double>(program_->readings.size() + program_->unknowns.size(), 0), x);
  auto traced = [&](const Hinge& h, int in) {
    Traced line = posture_.traced(static_cast<std::size_t>(h.axis), in);
    for (Expr& u : line.direction) u = Expr(h.sense) * u;
    return line;
  };
  Tape& tape = *program_->tape;
  auto value = [&](const Expr& e) { return tape.evaluate(e.node_on(tape), posture_.slots()); };
  std::vector<Expr> told;
  for (std::size_t k = 0; k < hinges_.size(); ++k) {
    const Traced line = traced(hinges_[k], hinges_[k].body);
    const Eigen::Isometry3d to_view = views[k].frame.inverse();
    Vector3<Expr> p, u;
    for (int i = 0; i < 3; ++i) {
      p[i] = Expr(to_view.translation()[i]);
      for (int j = 0; j < 3; ++j) {
        p[i] += Expr(to_view.linear()(i, j)) * line.point[j];
        u[i] += Expr(to_view.linear()(i, j)) * line.direction[j];
      }
    }
    const int m = views[k].main, a = m == 0 ? 1 : 0, b = m == 2 ? 1 : 2;
    if (value(u[m]) < 0)
      for (Expr& each : u) each = -each;
    for (int i : {a, b}) told.push_back(p[i] - p[m] / u[m] * u[i]);
    for (int i : {a, b}) told.push_back(atan2(u[i], u[m]));
  }
  for (std::size_t k = 0; k + 1 < hinges_.size(); ++k) {
    const Traced a = traced(hinges_[k], 0), b = traced(hinges_[k + 1], 0);
    const Vector3<Expr> across = b.point - a.point, normal = cross(a.direction, b.direction);
    const Expr sine = norm(normal);
    told.push_back(atan2(sine, dot(a.direction, b.direction)));
    // Nearly parallel lines: the distance of one's point from the other.
    told.push_back(value(sine) > 1e-9 ? dot(across, normal) / sine
                                      : norm(cross(a.direction, across)));
  }
  std::pair<std::vector<double>, Eigen::MatrixXd> out;
  out.second.setZero(static_cast<Eigen::Index>(told.size()),
                     static_cast<Eigen::Index>(program_->parameters.size()));
  for (std::size_t r = 0; r < told.size(); ++r) {
    out.first.push_back(value(told[r]));
    const auto by = gradient(told[r]);
    for (std::size_t i = 0; i < program_->parameters.size(); ++i)
      if (const auto d = by.find(program_->parameters[i].slot); d != by.end())
        out.second(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(i)) = value(d->second);
  }
  return out;
}

void AxisFinder::describe(Located& located, const std::vector<View>& views) {
  const Eigen::MatrixXd& C =
      located.observed ? located.covariance.observed : located.covariance.stated;
  const Eigen::MatrixXd& unbounded = located.covariance.unbounded;
  const std::size_t n = program_->parameters.size(), count = hinges_.size();
  const auto [here, G] = numbers(located.fit.x, views);
  Eigen::VectorXd tolerance(static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i)
    tolerance[static_cast<Eigen::Index>(i)] =
        program_->parameters[i].nominal.tolerance.value_or(std::numeric_limits<double>::infinity());
  auto std_of = [&, &G = G](Eigen::Index r) {
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
