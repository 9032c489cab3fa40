// Static loads of a linkage at a posture: what the weights of its links and payloads, all those
// farther from the root (distal), do to each joint and each link.
//
// With weights W_i = m_i g at c_i, the distal side exerts on the joint behind which the links D
// lie, at the point o,
//     f = sum_D W_i,      n = sum_D (c_i - o) x W_i,
// so that n along the axis is minus the derivative of the potential energy by the joint's angle.
// All branches of a tree count.
//
// A linkage that is held at a second frame (held_at of <gravity>) stands on both: nothing drives
// its joints, and the holder's force and moment R, six unknowns that act at that frame, follow from
// no torque by any coordinate q: sum over the joints that q moves of twist . (W + R) = 0. Least
// squares where more than six coordinates lead there: those can't all rest, and something else must
// hold them. Where fewer lead there, or at a singular posture, R is not determined: it is then the
// smallest, moments measured against the distance of the farthest axis.
//
// Forces in kg mm/s^2 (mN), moments in kg mm^2/s^2.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "framework/kinematics/axis_place.h"
#include "framework/kinematics/posture.h"

namespace talus {

struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
};

// Of the link behind the joint that leads to a frame.
struct LinkLoad {
  Wrench axis;  // all that is distal, in the joint's axis frame S (axis_place.h), about its origin;
                // where nothing moves, in the frame before it
  // In the frame behind it:
  Wrench tip;                  // what is distal of the frame: without the link's own weight
  Eigen::Vector3d weight;      // the link's own
  Eigen::Vector3d own_moment;  // of that weight, about this frame's origin
  Eigen::Vector3d span;        // from the frame before the joint to this one, mm
};

class Loads {
 public:
  // Like Posture, it records on the program's tape. Without gravity there are no loads.
  explicit Loads(const Program& program);

  // Readings, then unknowns; parameters as for Posture; the payloads' masses in the program's
  // order, or those that the model states (zero where a column does).
  void set(std::span<const double> coordinates, std::span<const double> parameters = {},
           std::span<const double> payloads = {});
  // From the next posture on, gravity points along this vector of its frame instead of the model's.
  void turn(const Eigen::Vector3d& direction) { down_ = direction.normalized(); }

  // By frame; the root's means nothing.
  const LinkLoad& link(int frame) const { return links_[frame]; }
  const std::vector<LinkLoad>& links() const { return links_; }
  // What the holder exerts, in the root frame about the held frame's origin.
  const Wrench& reaction() const { return reaction_; }
  const Posture& posture() const { return posture_; }

 private:
  void hold();  // finds the reaction and adds it

  const Program* program_;
  Eigen::Vector3d down_ = Eigen::Vector3d::Zero();
  Posture posture_;
  TapeValues places_;                // T_A_S of each frame, twelve numbers
  std::vector<int> free_;            // axes that a coordinate moves, on the way to the holder
  std::vector<Wrench> tip_, total_;  // in the root frame about its origin
  std::vector<LinkLoad> links_;
  Wrench reaction_;
};

}  // namespace talus
