// Painter's order of flat pieces seen from one direction: whatever is behind is painted first.
//
// Of two pieces that overlap in the picture the one whose plane is farther away in the middle of
// the overlap comes first; for pieces that do not cut through each other this is exact, which
// sorting by the distance of their middles is not. Where the pieces hide each other in a circle,
// the farthest of them comes first.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace talus {

struct Piece {
  std::vector<Eigen::Vector2d> outline;  // convex
  Eigen::Vector3d plane;                 // height towards the viewer = plane . (x, y, 1)
  double height(const Eigen::Vector2d& p) const { return plane.head<2>().dot(p) + plane.z(); }
};

std::vector<int> painters_order(std::vector<Piece> pieces);

// The middle of what two convex polygons (corners counterclockwise) have in common, and its area.
struct Overlap {
  Eigen::Vector2d middle;
  double area = 0;
};
Overlap overlap(const std::vector<Eigen::Vector2d>& a, const std::vector<Eigen::Vector2d>& b);

// Corners counterclockwise of the smallest convex polygon around the points.
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> points);

}  // namespace talus
