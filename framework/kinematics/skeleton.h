// The bones of a linkage at a posture: where each joint's centre is, and the lines that join the
// centres through the rigid bodies between them. Pictures draw it.
//
// A joint's centre is the origin of the frame in which its motion begins: of T_A_B, a product of
// elementary motions, all those before the first that depends on a coordinate have been made. For
// a Denavit-Hartenberg joint that is the origin of A, for a hinge through (x, y, z) that point.
// Unknowns that several poses share are placements, no coordinates. A bone goes from the joint
// before a body to each joint behind it: along the offsets d and a where they are given one after
// the other at right angles, straight otherwise.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "framework/kinematics/posture.h"

namespace talus {

// Where a point of the skeleton comes from: the origin of the frame after that many of the
// elementary motions that lead to `frame` from its parent.
struct Origin {
  int frame = 0;
  std::size_t motions = 0;
};

// Points in the root frame. It belongs to the rigid body of frame `from`.
struct Bone {
  int from = 0, to = 0;  // frames; equal where a body ends in its own frame
  std::vector<Eigen::Vector3d> points;
  std::vector<Origin> origins;  // of the points
};

class Skeleton {
 public:
  explicit Skeleton(const Program& program);
  void set(const Posture& posture);

  bool moves(int frame) const { return joints_[frame].moves; }  // the joint that leads to it
  int body(int frame) const { return joints_[frame].body; }     // the first frame of its rigid body
  bool leaf(int frame) const { return joints_[frame].leaf; }
  // Of the joint that leads to the frame; where nothing moves, the frame's origin.
  const Eigen::Vector3d& centre(int frame) const { return centres_[frame].at; }
  const Origin& centre_origin(int frame) const { return centres_[frame].origin; }
  const std::vector<Bone>& bones() const { return bones_; }
  const std::vector<Eigen::Isometry3d>& features() const { return features_; }  // T_root_feature

 private:
  struct Step {
    Motion<Expr>::Kind kind;
    int axis;
    std::size_t value;  // the first of its values
    bool moves;
  };
  struct Joint {
    std::vector<Step> steps;
    bool moves = false, leaf = true;
    int body = 0;
  };
  struct Feature {
    int in;
    std::vector<Step> steps;
  };
  struct Point {
    Eigen::Vector3d at;
    Origin origin;
  };
  using Points = std::vector<Point>;
  static void straighten(Points& points);

  std::vector<Step> steps_of(const Rigid<Expr>& motion, std::vector<std::int32_t>& nodes) const;
  static void apply(const Step& step, const std::vector<double>& values, Eigen::Isometry3d& T);
  bool returns(int frame) const;
  void walk(int frame, const Posture& posture, const std::vector<double>& values);

  const Program* program_;
  std::vector<bool> coordinate_;  // by slot
  TapeValues values_;
  std::vector<Joint> joints_;  // by frame
  std::vector<Feature> measured_;
  std::vector<Points> before_, after_;  // by frame: up to its joint's centre, and from there on
  Points centres_;
  std::vector<Bone> bones_;
  std::vector<Eigen::Isometry3d> features_;
};

}  // namespace talus
