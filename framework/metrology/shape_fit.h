// A shape (plane, line, circle, cylinder, sphere: any plugin of the family) fitted to points by
// least squares of its orthogonal deviations, with exact derivatives by the points.
//
// The shape's own frame, origin on it and z along its axis, is moved by three shifts and two turns
// (and the radius by itself) until the sum of squared deviations is least. Directions in which it
// may move without touching them (a plane along itself) stay where they are. How the result follows
// the points, dq = -J^+ (df/dp) dp, is what carries the points' noise into all that is made of
// them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "framework/kinematics/program.h"
#include "framework/kinematics/tape_values.h"

namespace talus {

// A vector worked out from the n raw coordinates of a pose, and its derivative by them (3 x n).
struct Derived {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Matrix3Xd by;
};

struct FittedShape {
  Derived origin, axis;                                // mm; unit vector
  double radius = 0;                                   // mm
  Eigen::Matrix3d held = Eigen::Matrix3d::Identity();  // projects on where the origin is determined
  double squares = 0;                                  // sum of squared deviations, mm^2
  int freedom = 0;                                     // numbers of the shape that the points fix
  int surplus = 0;  // deviations that its points could show beyond those that the fit takes up
  int points = 0;
  bool determined = false;  // by these points
  double sense = 1;  // how clearly the order of the points tells the axis's sense: 1 clear, 0 not
  bool ambiguous = false;  // another one, turned, fits them as well
};

class ShapeFitter {
 public:
  explicit ShapeFitter(const ProbedShape& shape);
  FittedShape fit(const std::vector<Derived>& points) const;

 private:
  struct Cost;
  ProbedShape shape_;
  Tape tape_;
  int per_point_ = 0;
  bool has_radius_ = false;
  mutable TapeValues
      values_;  // per deviation: the value, its derivatives by 6 unknowns, by 3 coordinates
};

// Points moved onto the plane of a shape, along its axis.
std::vector<Derived> projected(const std::vector<Derived>& points, const FittedShape& plane);

}  // namespace talus
