#include "framework/kinematics/posture.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "framework/kinematics/tape_values.h"

namespace talus {
namespace {

// A pose as rotation and translation, so that a tree's poses share their factors on the tape.
struct Placed {
  Matrix3<Expr> R{
      {{Expr(1), Expr(0), Expr(0)}, {Expr(0), Expr(1), Expr(0)}, {Expr(0), Expr(0), Expr(1)}}};
  Vector3<Expr> p;
  Placed operator*(const Motion<Expr>& motion) const {
    const Rigid<Expr> next = Rigid<Expr>(R, p) * Rigid<Expr>(motion);
    return {next.rotation(), next.translation()};
  }
};

}  // namespace

Posture::Posture(const Program& program)
    : program_(&program), slots_(program.slots, 0), frames_(program.frames.size()) {
  std::map<int, int> coordinates;  // slot -> number
  const int readings = static_cast<int>(program.readings.size());
  for (int i = 0; i < readings; ++i)
    if (!program.readings[i].covariate) coordinates.emplace(program.readings[i].slot, i);
  for (std::size_t i = 0; i < program.unknowns.size(); ++i)
    coordinates.emplace(program.unknowns[i].slot, readings + static_cast<int>(i));
  std::vector<std::int32_t> nodes;
  auto want = [&](const Expr& e) { nodes.push_back(e.node_on(*program.tape)); };
  std::vector<Placed> placed(program.frames.size());
  for (std::size_t f = 0; f < program.frames.size(); ++f) {
    const Frame& frame = program.frames[f];
    if (frame.parent >= 0) placed[f] = placed[frame.parent];
    for (const Motion<Expr>& m : frame.motion.motions()) placed[f] = placed[f] * m;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) want(placed[f].R[i][j]);
      want(placed[f].p[i]);
    }
  }
  // The joint's own motion by each coordinate it depends on: a twist, whatever the joint.
  for (std::size_t f = 0; f < program.frames.size(); ++f) {
    const Rigid<Expr>& motion = program.frames[f].motion;
    const Matrix3<Expr> R = motion.rotation();
    const Vector3<Expr> p = motion.translation();
    std::array<std::unordered_map<std::int32_t, Expr>, 12> by;
    std::set<int> own;
    for (int i = 0; i < 12; ++i) {
      by[i] = gradient(i < 9 ? R[i / 3][i % 3] : p[i - 9]);
      for (const auto& [slot, _] : by[i])
        if (coordinates.contains(slot)) own.insert(slot);
    }
    for (int slot : own) {
      auto derivative = [&](int i) { return by[i].contains(slot) ? by[i].at(slot) : Expr(0); };
      Matrix3<Expr> turn{};   // dR R^T = [w]
      Vector3<Expr> slide{};  // v = dp - w x p
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          for (int k = 0; k < 3; ++k) turn[i][j] += derivative(3 * i + k) * R[j][k];
      const Vector3<Expr> w{turn[2][1], turn[0][2], turn[1][0]}, across = cross(w, p);
      for (int i = 0; i < 3; ++i) slide[i] = derivative(9 + i) - across[i];
      for (int i = 0; i < 3; ++i) want(w[i]), want(slide[i]);
      twists_.push_back({w, slide});
      axes_.push_back(
          {static_cast<int>(f), program.frames[f].name, true, {}, {}, coordinates.at(slot)});
    }
  }
  values_ = TapeValues(*program.tape, std::move(nodes));
  for (const Placed& pose : placed) placed_.emplace_back(pose.R, pose.p);
}

Posture::TracedLine Posture::traced(std::size_t axis, int in) const {
  const auto& [w, slide] = twists_[axis];
  const int parent = program_->frames[axes_[axis].frame].parent;
  const Rigid<Expr> T = parent < 0 ? inverse(placed_[in]) : inverse(placed_[in]) * placed_[parent];
  const Matrix3<Expr> R = T.rotation();
  const Expr square = dot(w, w), size = sqrt(square);
  Vector3<Expr> foot = cross(w, slide), u;
  for (Expr& each : foot) each = each / square;
  for (int i = 0; i < 3; ++i) u[i] = dot(R[i], w) / size;
  return {T * foot, u};
}

void Posture::set(std::span<const double> coordinates, std::span<const double> parameters) {
  const std::size_t readings = program_->readings.size();
  for (std::size_t i = 0; i < program_->parameters.size(); ++i)
    slots_[program_->parameters[i].slot] =
        i < parameters.size() ? parameters[i] : program_->parameters[i].nominal.value;
  for (std::size_t i = 0; i < readings; ++i) slots_[program_->readings[i].slot] = coordinates[i];
  for (std::size_t i = 0; i < program_->unknowns.size(); ++i)
    slots_[program_->unknowns[i].slot] = coordinates[readings + i];
  const double* v = values_(slots_).data();
  for (Eigen::Isometry3d& pose : frames_) {
    pose.setIdentity();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j) pose.matrix()(i, j) = *v++;
  }
  for (JointAxis& axis : axes_) {
    Eigen::Vector3d w, slide;
    for (int i = 0; i < 3; ++i) w[i] = *v++, slide[i] = *v++;
    const int parent = program_->frames[axis.frame].parent;
    const Eigen::Isometry3d before = parent < 0 ? Eigen::Isometry3d::Identity() : frames_[parent];
    axis.turns = w.norm() > 1e-9;
    axis.rate = (axis.turns ? w : slide).norm();
    axis.pitch = axis.turns ? w.dot(slide) / w.squaredNorm() : 0;
    axis.direction = before.linear() * (axis.turns ? w : slide).normalized();
    axis.point = axis.turns ? before * (w.cross(slide) / w.squaredNorm()).eval()
                            : frames_[axis.frame].translation().eval();
  }
}

Apart apart(const JointAxis& a, const JointAxis& b) {
  const Eigen::Vector3d normal = a.direction.cross(b.direction), across = b.point - a.point;
  const double sine = normal.norm();
  Apart result;
  result.angle = std::atan2(sine, a.direction.dot(b.direction));
  // Nearly parallel lines: the distance of one's point from the other.
  result.distance = sine > 1e-9 ? std::abs(across.dot(normal)) / sine
                                : (across - across.dot(a.direction) * a.direction).norm();
  return result;
}

int axis_before(const Program& program, const std::vector<JointAxis>& axes, std::size_t axis) {
  for (int f = axes[axis].frame; f >= 0; f = program.frames[f].parent)
    for (std::size_t a = axis; a-- > 0;)
      if (axes[a].frame == f) return static_cast<int>(a);
  return -1;
}

}  // namespace talus
