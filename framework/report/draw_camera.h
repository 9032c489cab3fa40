// From where a linkage is looked at: an orthographic view, given as the azimuth and the elevation
// of the viewer. With z up the azimuth counts from x towards y, the elevation up from the plane of
// both; with another axis up the axes change places cyclically.
//
//     front  -90, 0    x to the right, z up          top  -90, 90   x to the right, y up
//     side     0, 0    y to the right, z up          iso  -45, 35.264   all three axes equally long
#pragma once

#include <Eigen/Core>
#include <string>

namespace talus {

struct Camera {
  Eigen::Matrix3d rows;  // what is to the right, up and towards the viewer, in the frame looked at

  // Right and up on the page and height above it, mm.
  Eigen::Vector3d operator()(const Eigen::Vector3d& p) const { return rows * p; }
};

// `direction`: a name or "azimuth, elevation" in degrees; `up`: x, y, z, -x, -y or -z. InputError
// for anything else.
Camera parse_camera(const std::string& direction, const std::string& up);

}  // namespace talus
