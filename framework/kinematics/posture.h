// Where every frame and every joint axis of a linkage is, pose after pose: what pictures, tables of
// motion and conversions between descriptions need. T_A_B maps coordinates given in B to A.
//
//     Posture posture(program);
//     posture.set(coordinates);                     // readings, then unknowns
//     Eigen::Isometry3d T_B_E = posture.between(program.frame("B", {}), program.frame("E", {}));
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <string>
#include <vector>

#include "framework/kinematics/program.h"
#include "framework/kinematics/tape_values.h"

namespace talus {

// The line about or along which a joint moves with one coordinate, in the root frame, at the
// posture that was set; in the sense of a growing reading or unknown. A screw's line is its axis.
struct JointAxis {
  int frame = -1;                    // the frame behind the joint
  std::string joint;                 // its name
  bool turns = true;                 // rotates about the line; otherwise slides along it
  Eigen::Vector3d point, direction;  // of the line: mm, unit vector
  int coordinate = -1;               // which moves it: number among readings, then unknowns
  double rate = 1, pitch = 0;  // rad (mm) per unit of the coordinate; mm along the line per rad

  // How a point of the body behind it moves per unit of the coordinate.
  Eigen::Vector3d turn() const { return turns ? Eigen::Vector3d(rate * direction) : zero(); }
  Eigen::Vector3d shift(const Eigen::Vector3d& p) const {
    return turns ? Eigen::Vector3d(turn().cross(p - point) + pitch * turn()) : rate * direction;
  }
  static Eigen::Vector3d zero() { return Eigen::Vector3d::Zero(); }
};

class Posture {
 public:
  // Not to be called at the same time on one program: it records on the program's tape.
  explicit Posture(const Program& program);

  // Readings, then unknowns, in the program's order (rad, mm). Parameters are at `parameters`, or
  // at their nominal values.
  void set(std::span<const double> coordinates, std::span<const double> parameters = {});

  const Eigen::Isometry3d& frame(int index) const { return frames_[index]; }  // T_root_frame
  Eigen::Isometry3d between(int in, int at) const {                           // T_in_at
    return frames_[in].inverse() * frames_[at];
  }
  const std::vector<double>& slots() const { return slots_; }  // what was set, by slot
  // One per joint and coordinate that moves it, in the order of the frames.
  const std::vector<JointAxis>& axes() const { return axes_; }

  // The line of an axis that turns, seen from a frame, as expressions on the program's tape: what
  // is made of it can be differentiated.
  struct TracedLine {
    Vector3<Expr> point, direction;
  };
  TracedLine traced(std::size_t axis, int in) const;
  // T_root_frame, and the turn and slide of the joint's motion by its coordinate, seen from the
  // frame before the joint.
  const Rigid<Expr>& placed(int frame) const { return placed_[frame]; }
  const std::array<Vector3<Expr>, 2>& twist(std::size_t axis) const { return twists_[axis]; }

 private:
  const Program* program_;
  TapeValues values_;
  std::vector<double> slots_;
  std::vector<Eigen::Isometry3d> frames_;
  std::vector<JointAxis> axes_;
  std::vector<Rigid<Expr>> placed_;                   // T_root_frame
  std::vector<std::array<Vector3<Expr>, 2>> twists_;  // of each axis: turn, slide, before the joint
};

// Distance (mm) and angle (rad, 0 to pi) between two lines.
struct Apart {
  double distance = 0, angle = 0;
};
Apart apart(const JointAxis& a, const JointAxis& b);

// The axis before an axis: of the nearest joint towards the root that moves; several coordinates of
// one joint are taken in turn. -1: none.
int axis_before(const Program& program, const std::vector<JointAxis>& axes, std::size_t axis);

}  // namespace talus
