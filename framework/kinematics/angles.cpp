#include "framework/kinematics/angles.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

namespace talus {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kSingular = 1e-12;  // |cos b| or |sin b|, as far as rounding can tell it from zero

// In (-pi, pi]; minus zero would make -pi of pi.
double direction(double y, double x) {
  const double angle = std::atan2(y, x);
  return angle <= -kPi ? kPi : angle;
}

Eigen::Matrix3d about(int axis, double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
}

}  // namespace

AxisSequence parse_axis_sequence(std::string_view text, const Place& place) {
  const std::string expected =
      "three of x, y, z in order, none twice running: xyz, xzy, yxz, yzx, zxy, zyx, xyx, xzx, yxy, "
      "yzy, zxz or zyz";
  AxisSequence sequence{};
  if (text.size() != 3)
    throw InputError(place, fmt::format("'{}' is not a sequence of axes", text), expected);
  for (int n = 0; n < 3; ++n) {
    sequence.axes[n] = text[n] - 'x';
    if (text[n] < 'x' || text[n] > 'z')
      throw InputError(place, fmt::format("'{}' is not an axis, in '{}'", text[n], text), expected);
    if (n > 0 && text[n] == text[n - 1])
      throw InputError(place, fmt::format("'{}' turns about {} twice running", text, text[n]),
                       expected);
  }
  return sequence;
}

Eigen::Matrix3d rotation_of(const std::array<double, 3>& angles, const AxisSequence& sequence) {
  return about(sequence.axes[0], angles[0]) * about(sequence.axes[1], angles[1]) *
         about(sequence.axes[2], angles[2]);
}

std::array<double, 3> angles_of(const Eigen::Matrix3d& R, const AxisSequence& sequence) {
  const auto [i, j, k] = sequence.axes;
  const int l = 3 - i - j;                            // the third axis; k is i or l
  const double sign = (j - i + 3) % 3 == 1 ? 1 : -1;  // of the permutation i, j, l
  // Row i: cos b cos c, -s cos b sin c, s sin b for different axes; cos b, sin b sin c, s sin b cos
  // c for k = i.
  const bool proper = k == i;
  const double across = proper ? std::hypot(R(i, j), R(i, l)) : std::hypot(R(i, i), R(i, j));
  const double b = proper ? std::atan2(across, R(i, i)) : std::atan2(sign * R(i, l), across);
  if (across <= kSingular) return {direction(sign * R(l, j), R(j, j)), b, 0};
  const double a =
      proper ? direction(R(j, i), -sign * R(l, i)) : direction(-sign * R(j, l), R(l, l));
  // Row j of R_i(a)^T R is that of R_k(c), whatever b is.
  const Eigen::RowVector3d row = std::cos(a) * R.row(j) + sign * std::sin(a) * R.row(l);
  const double c = proper ? direction(-sign * row[l], row[j]) : direction(sign * row[i], row[j]);
  return {a, b, c};
}

}  // namespace talus
