// Every registered shape: fitted to points on it, found again, with the right derivatives.
#include "framework/metrology/shape_fit.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "framework/registry/registry.h"
#include "tests/support/derivative_check.h"

using namespace talus;
using namespace talus::testing;
using Eigen::Vector3d;

namespace {

ProbedShape shape_of(const std::string& tag) {
  const Plugin& plugin = *Registry::built_in().find(tag, Family::shape);
  return {tag, tag, plugin.declaration, plugin.deviations};
}

// Points at which all deviations vanish: Newton's method from random points of the shape's own
// frame, ordered as the sense of its axis asks.
std::vector<Vector3d> points_on(const ProbedShape& shape, double radius, int count,
                                Random& random) {
  Tape tape;
  std::array<Expr, 3> p;
  for (int i = 0; i < 3; ++i) p[i] = Expr::leaf(tape, i);
  const auto deviations = shape.deviations(p, Expr(radius));
  std::vector<Vector3d> points;
  for (int k = 0; k < count; ++k) {
    Vector3d at(between(random, -20, 20), between(random, -20, 20), between(random, -20, 20));
    for (int step = 0; step < 60; ++step)
      for (const Expr& e : deviations) {
        const std::vector<double> slots{at[0], at[1], at[2]};
        Vector3d slope = Vector3d::Zero();
        for (const auto& [slot, by] : gradient(e))
          slope[slot] = by.is_constant() ? by.constant() : tape.evaluate(by.node(), slots);
        const double value = tape.evaluate(e.node_on(tape), slots);
        if (slope.squaredNorm() > 0) at -= slope * value / slope.squaredNorm();
      }
    points.push_back(at);
  }
  std::sort(points.begin(), points.end(), [&](const Vector3d& a, const Vector3d& b) {
    return shape.declaration.sense == Sense::along
               ? a.z() < b.z()
               : std::atan2(a.y(), a.x()) < std::atan2(b.y(), b.x());
  });
  return points;
}

std::vector<Derived> own(const std::vector<Vector3d>& points) {
  std::vector<Derived> result;
  const auto n = static_cast<Eigen::Index>(points.size());
  for (Eigen::Index k = 0; k < n; ++k) {
    result.push_back({points[k], Eigen::Matrix3Xd::Zero(3, 3 * n)});
    result.back().by.middleCols<3>(3 * k).setIdentity();
  }
  return result;
}

// The point of a moved shape beside the origin it had: a plane or an axis may be given by any of
// its points.
Vector3d beside(const FittedShape& moved, const FittedShape& at) {
  const Vector3d away = moved.origin.value - at.origin.value, &n = at.axis.value,
                 &d = moved.axis.value;
  if (at.held.trace() < 1.5) return at.origin.value + n * away.dot(d) / n.dot(d);
  if (at.held.trace() < 2.5) return moved.origin.value - d * away.dot(n) / d.dot(n);
  return moved.origin.value;
}

}  // namespace

TEST_CASE("every shape is found again from points on it, wherever it lies") {
  Random random(7);
  const auto tags = Registry::built_in().tags(Family::shape);
  REQUIRE(tags.size() >= 5);
  for (const std::string& tag : tags) {
    CAPTURE(tag);
    const ProbedShape shape = shape_of(tag);
    const ShapeFitter fitter(shape);
    for (int trial = 0; trial < 20; ++trial) {
      const double radius = between(random, 5, 20);
      const Eigen::Isometry3d place =
          Eigen::Translation3d(between(random, -300, 300), 40, -100) *
          Eigen::Quaterniond(Eigen::Vector4d(between(random, -1, 1), between(random, -1, 1),
                                             between(random, -1, 1), between(random, 0.1, 1)))
              .normalized();
      auto points = points_on(shape, radius, 12, random);
      for (Vector3d& p : points) p = place * p;
      const FittedShape fit = fitter.fit(own(points));
      CHECK(fit.determined);
      CHECK(!fit.ambiguous);
      CHECK(std::sqrt(fit.squares) < 1e-7);  // mm
      CHECK(fit.freedom == shape.declaration.freedom);
      // Where the shape holds its origin, it is the true one; so is its axis, sense included.
      CHECK((fit.held * (fit.origin.value - place.translation())).norm() < 1e-6);
      if (shape.declaration.sense != Sense::none)
        CHECK((fit.axis.value - place.linear().col(2)).norm() < 1e-6);
    }
  }
}

TEST_CASE("how a fitted shape follows its points agrees with differences") {
  Random random(8);
  for (const std::string& tag : Registry::built_in().tags(Family::shape)) {
    CAPTURE(tag);
    const ProbedShape shape = shape_of(tag);
    const ShapeFitter fitter(shape);
    const auto points = points_on(shape, 12, 9, random);
    const FittedShape at = fitter.fit(own(points));
    const double h = 1e-4;
    for (std::size_t k = 0; k < points.size(); ++k)
      for (int i = 0; i < 3; ++i) {
        auto moved = points;
        moved[k][i] += h;
        const FittedShape up = fitter.fit(own(moved));
        moved[k][i] -= 2 * h;
        const FittedShape down = fitter.fit(own(moved));
        const Vector3d origin = (beside(up, at) - beside(down, at)) / (2 * h);
        const auto c = static_cast<Eigen::Index>(3 * k + i);
        CHECK((at.held * (origin - at.origin.by.col(c))).norm() < 2e-5);
        if (shape.declaration.sense != Sense::none)
          CHECK(((up.axis.value - down.axis.value) / (2 * h) - at.axis.by.col(c)).norm() < 2e-5);
      }
  }
}

TEST_CASE("points that do not determine a shape, or fit two, are recognised") {
  const ShapeFitter plane(shape_of("plane"));
  CHECK(!plane.fit(own({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}})).determined);
  const ProbedShape cylinder = shape_of("cylinder");
  std::vector<Vector3d> box;
  for (double z : {5.0, 30.0})
    for (auto [x, y] : {std::pair{12.0, 0.0}, {0.0, 12.0}, {-12.0, 0.0}, {0.0, -12.0}})
      box.push_back({x, y, z});
  CHECK(ShapeFitter(cylinder).fit(own(box)).ambiguous);
}

TEST_CASE("a known radius is held") {
  ProbedShape sphere = shape_of("sphere");
  sphere.radius = 5;
  const FittedShape fit = ShapeFitter(sphere).fit(
      own({{5.1, 0, 0}, {-5.1, 0, 0}, {0, 5.1, 0}, {0, -5.1, 0}, {0, 0, 5.1}}));
  CHECK(fit.radius == 5);
  CHECK(fit.freedom == 3);
  CHECK(fit.determined);
}

TEST_CASE("points are projected on a plane") {
  const FittedShape plane =
      ShapeFitter(shape_of("plane")).fit(own({{0, 0, 2}, {10, 0, 2}, {10, 10, 2}, {0, 10, 2}}));
  for (const Derived& p : projected(own({{1, 2, 3}, {4, 5, -6}, {7, 7, 7}, {0, 0, 0}}), plane))
    CHECK(p.value.z() == doctest::Approx(2));
}
