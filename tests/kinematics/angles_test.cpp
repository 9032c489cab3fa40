#include "framework/kinematics/angles.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "framework/model/units.h"

using namespace talus;

namespace {

const std::vector<std::string> sequences{"xyz", "xzy", "yxz", "yzx", "zxy", "zyx",
                                         "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"};

// Written out, not taken from the code under test.
Eigen::Matrix3d about(char axis, double t) {
  const double c = std::cos(t), s = std::sin(t);
  Eigen::Matrix3d R;
  if (axis == 'x') R << 1, 0, 0, 0, c, -s, 0, s, c;
  if (axis == 'y') R << c, 0, s, 0, 1, 0, -s, 0, c;
  if (axis == 'z') R << c, -s, 0, s, c, 0, 0, 0, 1;
  return R;
}
Eigen::Matrix3d composed(const std::string& sequence, const std::array<double, 3>& angles) {
  return about(sequence[0], angles[0]) * about(sequence[1], angles[1]) *
         about(sequence[2], angles[2]);
}
double farthest(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return (a - b).cwiseAbs().maxCoeff();
}
double turn(double difference) { return std::abs(std::remainder(difference, 360 * deg)); }

}  // namespace

TEST_CASE("the angles of a composition, for all twelve sequences over the whole range") {
  for (const std::string& name : sequences) {
    CAPTURE(name);
    const AxisSequence sequence = parse_axis_sequence(name, {});
    const bool proper = name[0] == name[2];
    double worst = 0, worst_angle = 0;
    bool in_range = true;
    for (int a = -180; a <= 180; a += 15)
      for (int b = -180; b <= 180; b += 15)
        for (int c = -180; c <= 180; c += 15) {
          const std::array<double, 3> given{a * deg, b * deg, c * deg};
          const Eigen::Matrix3d R = composed(name, given);
          const auto found = angles_of(R, sequence);
          worst = std::max(worst, farthest(composed(name, found), R));
          worst = std::max(worst, farthest(rotation_of(given, sequence), R));
          for (double v : {found[0], found[2]})
            in_range &= v > -180 * deg - 1e-15 && v <= 180 * deg + 1e-15;
          const double low = proper ? 0 : -90 * deg, high = proper ? 180 * deg : 90 * deg;
          in_range &= found[1] >= low && found[1] <= high + 1e-15;
          // Inside its range the middle angle, and so all three, come back.
          if (b * deg > low + 1e-9 && b * deg < high - 1e-9)
            for (int n = 0; n < 3; ++n)
              worst_angle = std::max(worst_angle, turn(found[n] - given[n]));
        }
    CHECK(worst < 1e-14);
    CHECK(worst_angle < 1e-14);
    CHECK(in_range);
  }
}

TEST_CASE("at the singular points the last angle is zero and the rotation is kept") {
  for (const std::string& name : sequences) {
    CAPTURE(name);
    const AxisSequence sequence = parse_axis_sequence(name, {});
    const bool proper = name[0] == name[2];
    for (double b : proper ? std::vector<double>{0, 180} : std::vector<double>{-90, 90}) {
      const Eigen::Matrix3d R = composed(name, {40 * deg, b * deg, 25 * deg});
      const auto found = angles_of(R, sequence);
      CHECK(found[2] == 0);
      CHECK(farthest(composed(name, found), R) < 1e-14);
      // Next to it: the sum of first and last is kept as well as ever, however they share it.
      for (double step : {1e-15, 1e-13, 1e-11, 1e-9, 1e-6}) {
        const double inwards = b == 90 || b == 180 ? -step : step;
        const Eigen::Matrix3d near = composed(name, {40 * deg, b * deg + inwards, 25 * deg});
        CHECK(farthest(composed(name, angles_of(near, sequence)), near) < 3e-12);
      }
    }
  }
}

TEST_CASE("half a turn is +180 deg, not -180") {
  CHECK(angles_of(about('z', -180 * deg), parse_axis_sequence("zxy", {}))[0] > 0);
  CHECK(angles_of(about('x', -180 * deg), parse_axis_sequence("zyx", {}))[2] > 0);
}

TEST_CASE("what is not a sequence of axes is refused") {
  for (const char* bad : {"zxx", "xx", "xyzx", "abc", "zxw", "", "XYZ"}) {
    CAPTURE(bad);
    CHECK_THROWS_AS(parse_axis_sequence(bad, {"--angles", 0, 0}), InputError);
  }
  try {
    parse_axis_sequence("zxx", {"--angles zxx", 0, 0});
  } catch (const InputError& e) {
    CHECK(std::string(e.what()) ==
          "--angles zxx: 'zxx' turns about x twice running\n"
          "  expected three of x, y, z in order, none twice running: xyz, xzy, yxz, yzx, zxy, zyx, "
          "xyx, xzx, yxy, yzy, zxz or zyz");
  }
}
