#include "framework/kinematics/loads.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace talus {
namespace {

using Eigen::Isometry3d, Eigen::Vector3d;

Vector3d vector(const Vector3<double>& v) { return {v[0], v[1], v[2]}; }

// A force at a point, about the origin.
Wrench at(const Vector3d& point, const Vector3d& force) { return {force, point.cross(force)}; }

Wrench& operator+=(Wrench& a, const Wrench& b) {
  a.force += b.force;
  a.moment += b.moment;
  return a;
}

// Given in the root frame about its origin: in another frame about that one's.
Wrench seen_from(const Isometry3d& T_root_F, const Wrench& w) {
  const auto R_F_root = T_root_F.linear().transpose();
  return {R_F_root * w.force, R_F_root * (w.moment - T_root_F.translation().cross(w.force))};
}

std::vector<std::int32_t> place_nodes(const Program& program) {
  std::vector<std::int32_t> nodes;
  for (const Frame& frame : program.frames) {
    const Matrix3<Expr> R = frame.to_axis.rotation();
    const Vector3<Expr> p = frame.to_axis.translation();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) nodes.push_back(R[i][j].node_on(*program.tape));
      nodes.push_back(p[i].node_on(*program.tape));
    }
  }
  return nodes;
}

}  // namespace

Loads::Loads(const Program& program)
    : program_(&program),
      posture_(program),
      places_(*program.tape, place_nodes(program)),
      tip_(program.frames.size()),
      total_(program.frames.size()),
      links_(program.frames.size()) {
  if (program.gravity) down_ = vector(program.gravity->direction);
  std::vector<bool> to_holder(program.frames.size());
  for (int f = program.gravity ? program.gravity->held_at : -1; f >= 0;
       f = program.frames[f].parent)
    to_holder[f] = true;
  const int readings = static_cast<int>(program.readings.size());
  for (const JointAxis& axis : posture_.axes())  // a shared unknown is a placement
    if (to_holder[axis.frame] &&
        (axis.coordinate < readings || program.unknowns[axis.coordinate - readings].per.empty()))
      free_.push_back(static_cast<int>(&axis - posture_.axes().data()));
}

void Loads::set(std::span<const double> coordinates, std::span<const double> parameters,
                std::span<const double> payloads) {
  posture_.set(coordinates, parameters);
  std::fill(tip_.begin(), tip_.end(), Wrench{});
  std::fill(links_.begin(), links_.end(),
            LinkLoad{{}, {}, Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()});
  reaction_ = {};
  const auto& frames = program_->frames;
  Vector3d g = Vector3d::Zero();
  if (const auto& gravity = program_->gravity)
    g = gravity->magnitude * (posture_.frame(gravity->frame).linear() * down_);
  for (std::size_t i = 0; i < program_->payloads.size(); ++i) {
    const Payload& payload = program_->payloads[i];
    const double mass = i < payloads.size() ? payloads[i] : payload.mass;
    tip_[payload.frame] += at(posture_.frame(payload.frame).translation(), mass * g);
  }
  total_ = tip_;
  for (const Link& link : program_->links) {
    const Isometry3d& T = posture_.frame(link.frame);
    total_[link.frame] += at(T * vector(link.com), link.mass * g);
    links_[link.frame].weight = link.mass * (T.linear().transpose() * g);
    links_[link.frame].own_moment = vector(link.com).cross(links_[link.frame].weight);
  }
  for (std::size_t f = frames.size(); f-- > 1;) {  // parents stand before their children
    tip_[frames[f].parent] += total_[f];
    total_[frames[f].parent] += total_[f];
  }
  if (program_->gravity && program_->gravity->held_at >= 0) hold();
  const double* v = places_(posture_.slots()).data() + 12;
  for (std::size_t f = 1; f < frames.size(); ++f) {
    Isometry3d T_A_S = Isometry3d::Identity();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j) T_A_S.matrix()(i, j) = *v++;
    const Isometry3d &A = posture_.frame(frames[f].parent),
                     &B = posture_.frame(static_cast<int>(f));
    links_[f].axis = seen_from(A * T_A_S, total_[f]);
    links_[f].tip = seen_from(B, tip_[f]);
    links_[f].span = B.linear().transpose() * (B.translation() - A.translation());
  }
}

void Loads::hold() {
  const int held = program_->gravity->held_at;
  const Vector3d h = posture_.frame(held).translation();
  const Eigen::Index n =
      static_cast<Eigen::Index>(program_->readings.size() + program_->unknowns.size());
  double reach = 0;  // of the farthest axis from the held frame
  for (const int i : free_)
    if (const JointAxis& axis = posture_.axes()[i]; axis.turns)
      reach = std::max(reach, axis.direction.cross(h - axis.point).norm());
  if (!(reach > 0)) reach = 1;
  // A row per coordinate: the power of the holder's moment (over `reach`) and force, and of the
  // weights, as it moves.
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, 6);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  for (const int i : free_) {
    const JointAxis& axis = posture_.axes()[i];
    A.row(axis.coordinate).head<3>() += reach * axis.turn();
    A.row(axis.coordinate).tail<3>() += axis.shift(h);
    const Wrench& weights = total_[axis.frame];
    b[axis.coordinate] -=
        axis.turn().dot(weights.moment) + axis.shift(Vector3d::Zero()).dot(weights.force);
  }
  for (Eigen::Index i = 0; i < n; ++i)  // a slide and a hinge count alike
    if (const double size = A.row(i).norm(); size > 0) A.row(i) /= size, b[i] /= size;
  Eigen::VectorXd x = Eigen::VectorXd::Constant(6, std::nan(""));
  if (A.allFinite() && b.allFinite()) {
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(n, 6);
    solver.setThreshold(1e-6);
    x = solver.compute(A).solve(b);
  }
  reaction_ = {x.tail<3>(), reach * x.head<3>()};
  const Wrench about_origin{reaction_.force, reaction_.moment + h.cross(reaction_.force)};
  tip_[held] += about_origin;
  total_[held] += about_origin;
  for (int f = held; f > 0; f = program_->frames[f].parent) {
    tip_[program_->frames[f].parent] += about_origin;
    total_[program_->frames[f].parent] += about_origin;
  }
}

}  // namespace talus
