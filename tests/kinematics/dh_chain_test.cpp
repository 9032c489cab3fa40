#include "framework/kinematics/dh_chain.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "framework/model/units.h"

using namespace talus;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

Isometry3d link_transform(const DhLink& k) {
  return Eigen::AngleAxisd(k.theta, Vector3d::UnitZ()) * Eigen::Translation3d(0, 0, k.d) *
         Eigen::Translation3d(k.a, 0, 0) * Eigen::AngleAxisd(k.alpha, Vector3d::UnitX());
}

// Whether the links are Denavit-Hartenberg links of these axes.
void check_links(const std::vector<AxisLine>& axes) {
  const std::vector<DhLink> links = dh_links(axes);
  REQUIRE(links.size() == axes.size());
  for (std::size_t k = 0; k < links.size(); ++k) {
    CAPTURE(k);
    const DhLink& link = links[k];
    const double scale = 1 + link.before.translation().norm() + link.behind.translation().norm();
    CHECK((link.before.linear().col(2) - axes[k].direction).norm() < 1e-12);
    CHECK((link.before.translation() - axes[k].point).cross(axes[k].direction).norm() <
          1e-12 * scale);
    CHECK(((link.before * link_transform(link)).matrix() - link.behind.matrix())
              .cwiseAbs()
              .maxCoeff() < 1e-12 * scale);
    CHECK((link.before.linear() * link.before.linear().transpose() - Eigen::Matrix3d::Identity())
              .norm() < 1e-12);
    if (k > 0) CHECK((links[k - 1].behind.matrix() - link.before.matrix()).norm() == 0);
    CHECK(link.a >= -1e-9);
  }
}

const Vector3d X = Vector3d::UnitX(), Y = Vector3d::UnitY(), Z = Vector3d::UnitZ();

}  // namespace

TEST_CASE("skew axes: a and alpha are distance and angle, d the way between the normals") {
  const std::vector<AxisLine> axes{{{0, 0, 7}, Z}, {{30, 5, 20}, Y}, {{30, 0, 60}, X}};
  check_links(axes);
  const auto links = dh_links(axes);
  CHECK(links[0].theta == 0);
  CHECK(links[0].d == 0);
  CHECK(links[0].a == doctest::Approx(30));
  CHECK(links[0].alpha == doctest::Approx(-90 * deg));
  CHECK(links[1].a == doctest::Approx(40));
  CHECK(std::abs(links[1].d) < 1e-12);
  CHECK(links[2].a == 0);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<AxisLine> chain;
    for (int k = 0; k < 6; ++k) {
      auto any = [&] { return Vector3d(normal(random), normal(random), normal(random)); };
      chain.push_back({100 * any(), any().normalized()});
    }
    check_links(chain);
  }
}

TEST_CASE("parallel, opposite, intersecting and coincident axes, and one alone") {
  const AxisLine at_0{{0, 0, 5}, Z}, at_50{{50, 0, -90}, Z}, down_at_50{{50, 0, 3}, -Z},
      crossing{{0, 0, 12}, (X + Z).normalized()}, same{{0, 0, -40}, Z};
  for (const auto& axes : std::vector<std::vector<AxisLine>>{{at_0},
                                                             {at_0, at_50},
                                                             {at_0, down_at_50},
                                                             {at_0, crossing},
                                                             {at_0, same},
                                                             {at_0, same, at_50, down_at_50},
                                                             {crossing, at_0, same, crossing},
                                                             {down_at_50, crossing, at_50}})
    check_links(axes);
  CHECK(dh_links({at_0, at_50})[0].d == 0);
  CHECK(dh_links({at_0, at_50})[0].a == doctest::Approx(50));
  CHECK(dh_links({at_0, at_50})[0].alpha == 0);
  CHECK(dh_links({at_0, at_50})[0].before.translation().norm() < 1e-12);  // nearest to the root
  CHECK(std::abs(dh_links({at_0, down_at_50})[0].alpha) == doctest::Approx(180 * deg));
  const auto three = dh_links({crossing, at_0, at_50});
  CHECK(std::abs(three[0].a) < 1e-12);
  CHECK(std::abs(three[1].d) < 1e-12);  // through the point where the first two cross
  CHECK(three[1].before.translation().z() == doctest::Approx(12));
  CHECK(dh_links({at_0, same})[0].a == 0);
  CHECK(dh_links({}).empty());
}

TEST_CASE("nearly parallel axes have their common normal far away") {
  std::vector<AxisLine> axes{{{0, 0, 0}, Z}, {{50, 1, 0}, Vector3d(0, 1e-4, 1).normalized()}};
  check_links(axes);
  CHECK(std::abs(dh_links(axes)[0].before.translation().z()) == doctest::Approx(1e4).epsilon(1e-3));
  CHECK(least_sine(axes) == doctest::Approx(1e-4));
  axes[1].direction = Z;
  CHECK(least_sine(axes) == 1);
}
