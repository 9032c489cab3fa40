#include "framework/kinematics/pose_values.h"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

std::vector<std::int32_t> nodes(const Program& program, const Rigid<Expr>& transform) {
  std::vector<std::int32_t> result;
  const Matrix3<Expr> R = transform.rotation();
  const Vector3<Expr> p = transform.translation();
  for (int i = 0; i < 9; ++i) result.push_back(R[i / 3][i % 3].node_on(*program.tape));
  for (int i = 0; i < 3; ++i) result.push_back(p[i].node_on(*program.tape));
  return result;
}

}  // namespace

PoseValues::PoseValues(const Program& program, const Rigid<Expr>& transform)
    : values_(*program.tape, nodes(program, transform)) {}

PlainPose PoseValues::operator()(std::span<const double> slots) {
  const auto& v = values_(slots);
  PlainPose pose;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pose.rotation[i][j] = v[3 * i + j];
    pose.translation[i] = v[9 + i];
  }
  return pose;
}

std::vector<double> slots_at(const Program& program, std::span<const double> coordinates) {
  std::vector<double> slots(program.slots, 0);
  for (const Parameter& p : program.parameters) slots[p.slot] = p.nominal.value;
  std::size_t next = 0;
  for (const Reading& r : program.readings) slots[r.slot] = coordinates[next++];
  for (const Unknown& u : program.unknowns) slots[u.slot] = coordinates[next++];
  return slots;
}

void set_chain(const Chain& chain, const PlainPose& pose, std::span<double> slots) {
  for (int i = 0; i < 9; ++i) slots[chain.first_slot + i] = pose.rotation[i / 3][i % 3];
  for (int i = 0; i < 3; ++i) slots[chain.first_slot + 9 + i] = pose.translation[i];
}

std::array<double, 4> quaternion(const Matrix3<double>& R) {
  std::array<double, 4> q{};  // w x y z; the largest component first for accuracy
  const double t[4] = {R[0][0] + R[1][1] + R[2][2], R[0][0] - R[1][1] - R[2][2],
                       R[1][1] - R[0][0] - R[2][2], R[2][2] - R[0][0] - R[1][1]};
  const int k = static_cast<int>(std::max_element(t, t + 4) - t);
  const double s = 2 * std::sqrt(1 + t[k]);
  q[k] = s / 4;
  const double skew[3] = {R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1]};
  if (k == 0) {
    for (int i = 0; i < 3; ++i) q[1 + i] = skew[i] / s;
  } else {
    q[0] = skew[k - 1] / s;
    for (int i = 0; i < 3; ++i)
      if (i != k - 1) q[1 + i] = (R[k - 1][i] + R[i][k - 1]) / s;
  }
  if (q[0] < 0)
    for (double& v : q) v = -v;
  return q;
}

}  // namespace talus
