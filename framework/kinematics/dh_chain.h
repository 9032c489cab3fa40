// Denavit-Hartenberg parameters of a serial chain of axes, distal form:
//     T_k-1_k = Rz(theta_k) Tz(d_k) Tx(a_k) Rx(alpha_k)
// with z of frame k-1 along axis k and x of frame k along the common normal from axis k to axis
// k+1. The frames follow from the lines alone; nothing says that they lie in the bodies they belong
// to (Storey et al. 2006, sec. I).
//
// Where the lines leave a choice:
//     parallel axes      the normal through the frame before: d = 0 (for the first, through the
//                        point of axis 1 nearest to the root's origin)
//     intersecting axes  a = 0, x along the cross product of their directions
//     one and the same   a = 0, x as before
//     first frame        at the first normal's foot, x along it: theta = 0 at the reference
//     posture, d = 0 last frame         the one before, turned: d = a = alpha = 0
#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace talus {

struct AxisLine {
  Eigen::Vector3d point, direction;  // mm, unit vector
};

struct DhLink {
  double theta = 0, d = 0, a = 0, alpha = 0;  // theta at the posture in which the lines are given
  Eigen::Isometry3d before, behind;           // frames k-1 and k there, in the lines' frame
};

std::vector<DhLink> dh_links(const std::vector<AxisLine>& axes);

// The sine of the smallest angle, other than none, between two consecutive axes: how far off common
// normals may lie.
double least_sine(const std::vector<AxisLine>& axes);

}  // namespace talus
