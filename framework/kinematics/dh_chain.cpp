#include "framework/kinematics/dh_chain.h"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kParallel = 1e-12;  // sine: what rounding makes of parallel axes
constexpr double kTouching = 1e-9;   // mm

Isometry3d frame(const Vector3d& origin, const Vector3d& x, const Vector3d& z) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() << x, z.cross(x), z;
  T.translation() = origin;
  return T;
}

Vector3d foot(const AxisLine& line, const Vector3d& from) {
  return line.point + line.direction.dot(from - line.point) * line.direction;
}

// Angle from a to b about the unit vector u.
double about(const Vector3d& u, const Vector3d& a, const Vector3d& b) {
  return std::atan2(u.dot(a.cross(b)), a.dot(b));
}

// x across a direction, as near to the x axis as may be (to y where that is the direction).
Vector3d across(const Vector3d& direction) {
  const Vector3d near = std::abs(direction.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  return (near - direction.dot(near) * direction).normalized();
}

struct Normal {
  Vector3d from, to, x;  // its feet on both axes, its direction
};

// `origin` and `x` of the frame before settle what the lines leave open.
Normal common_normal(const AxisLine& a, const AxisLine& b, const Vector3d& origin,
                     const Vector3d& x) {
  const Vector3d cross = a.direction.cross(b.direction), between = b.point - a.point;
  const double sine = cross.norm();
  if (sine > kParallel) {
    const Vector3d n = cross / sine;
    const double s = between.dot(b.direction.cross(n)) / sine,
                 t = between.dot(a.direction.cross(n)) / sine;
    Normal normal{a.point + s * a.direction, b.point + t * b.direction, n};
    if ((normal.to - normal.from).dot(n) < -kTouching) normal.x = -n;
    return normal;
  }
  Normal normal{origin, foot(b, origin), x};
  const Vector3d gap = normal.to - normal.from;
  if (gap.norm() > kTouching) normal.x = (gap - a.direction.dot(gap) * a.direction).normalized();
  return normal;
}

}  // namespace

std::vector<DhLink> dh_links(const std::vector<AxisLine>& axes) {
  std::vector<DhLink> links;
  if (axes.empty()) return links;
  Vector3d origin = foot(axes[0], Vector3d::Zero()), x = across(axes[0].direction);
  if (axes.size() > 1) {
    const Normal first = common_normal(axes[0], axes[1], origin, x);
    origin = first.from, x = first.x;
  }
  Isometry3d last = frame(origin, x, axes[0].direction);
  for (std::size_t k = 0; k + 1 < axes.size(); ++k) {
    const Vector3d z = axes[k].direction;
    const Normal normal = common_normal(axes[k], axes[k + 1], origin, x);
    DhLink link;
    link.theta = about(z, x, normal.x);
    link.d = (normal.from - origin).dot(z);
    link.a = (normal.to - normal.from).dot(normal.x);
    link.alpha = about(normal.x, z, axes[k + 1].direction);
    link.before = last;
    origin = normal.to, x = normal.x;
    last = link.behind = frame(origin, x, axes[k + 1].direction);
    links.push_back(link);
  }
  links.push_back({0, 0, 0, 0, last, last});
  return links;
}

double least_sine(const std::vector<AxisLine>& axes) {
  double least = 1;
  for (std::size_t k = 0; k + 1 < axes.size(); ++k) {
    const double sine = axes[k].direction.cross(axes[k + 1].direction).norm();
    if (sine > kParallel) least = std::min(least, sine);
  }
  return least;
}

}  // namespace talus
