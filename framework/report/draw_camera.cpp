#include "framework/report/draw_camera.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/model/error.h"
#include "framework/model/quantity.h"

namespace talus {
namespace {

// Azimuth and elevation, rad.
std::pair<double, double> angles(const std::string& text) {
  const Place place{"--view " + text, 0, 0};
  const std::vector<std::string> names{"front", "side", "top", "iso"};
  if (text == "front") return {-90 * deg, 0};
  if (text == "side") return {0, 0};
  if (text == "top") return {-90 * deg, 90 * deg};
  if (text == "iso") return {-45 * deg, std::atan(std::sqrt(0.5))};
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos)
    throw InputError(place, "no such view", "front, side, top, iso, or \"azimuth, elevation\"",
                     nearest(text, names));
  auto angle_of = [&](std::string word) {
    word.erase(0, word.find_first_not_of(' '));
    return parse_quantity(word, angle, UnitSystem{}, place).value;
  };
  const double elevation = angle_of(text.substr(comma + 1));
  if (std::abs(elevation) > 90 * deg * (1 + 1e-12))
    throw InputError(place, "no such elevation", "-90 to 90 deg");
  return {angle_of(text.substr(0, comma)), elevation};
}

}  // namespace

Camera parse_camera(const std::string& direction, const std::string& up) {
  const bool down = up.size() == 2 && up[0] == '-';
  const char letter = up.empty() ? ' ' : up.back();
  if ((up.size() != 1 && !down) || letter < 'x' || letter > 'z')
    throw InputError({"--up " + up, 0, 0}, "no such axis", "x, y, z, -x, -y or -z");
  const int axis = letter - 'x';
  Eigen::Matrix3d basis;  // columns: where the azimuth begins, where it goes, up
  for (int i = 0; i < 3; ++i) basis.col(i) = Eigen::Vector3d::Unit((axis + 1 + i) % 3);
  if (down) basis.rightCols<2>() *= -1;
  const auto [azimuth, elevation] = angles(direction);
  const double ca = std::cos(azimuth), sa = std::sin(azimuth), ce = std::cos(elevation),
               se = std::sin(elevation);
  Eigen::Matrix3d rows;
  rows << -sa, ca, 0, -se * ca, -se * sa, ce, ce * ca, ce * sa, se;
  return {rows * basis.transpose()};
}

}  // namespace talus
