#include "framework/diagnosis/closed_loops.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace talus {
namespace {

constexpr int kSteps = 60;
constexpr double kClosed = 1e-6;  // mm, and rad times 1,000 mm
constexpr double kArm = 1000;     // mm: a turn counts as what it moves at this distance
constexpr double kLargest = 0.4;  // rad, or share of a range, in one step

}  // namespace

ClosedLoops::ClosedLoops(const Program& program) : program_(&program), posture_(program) {
  for (std::size_t f = 0; f < program.features.size(); ++f) {
    const Feature& feature = program.features[f];
    if (feature.kind != Kind::nothing) continue;
    const Chain& chain = program.chains[feature.chain];
    Loop loop{feature.name,
              program.frame(chain.in, feature.place),
              program.frame(chain.at, feature.place),
              false,
              false,
              {}};
    for (const Row& row : program.rows)
      if (row.feature == static_cast<int>(f))
        (row.dimension == length ? loop.place : loop.turn) = true;
    auto above = [&](int frame) {
      std::vector<bool> on(program.frames.size());
      for (; frame >= 0; frame = program.frames[frame].parent) on[frame] = true;
      return on;
    };
    const std::vector<bool> at = above(loop.at), in = above(loop.in);
    for (const JointAxis& axis : posture_.axes())
      loop.moves.push_back({static_cast<bool>(at[axis.frame]), static_cast<bool>(in[axis.frame])});
    loops_.push_back(std::move(loop));
  }
}

std::vector<std::string> ClosedLoops::names() const {
  std::vector<std::string> result;
  for (const Loop& loop : loops_) result.push_back(loop.name);
  return result;
}

bool ClosedLoops::close(std::vector<double>& setting, const std::vector<Coordinate>& coordinates,
                        std::span<const double> parameters) {
  const auto n = static_cast<Eigen::Index>(coordinates.size());
  Eigen::VectorXd size = Eigen::VectorXd::Zero(n);  // of a move: a radian, or a share of a range
  for (Eigen::Index i = 0; i < n; ++i)
    if (const auto& c = coordinates[static_cast<std::size_t>(i)];
        c.range && !(c.dimension == number))
      size[i] = c.dimension == angle ? 1 : c.range->second - c.range->first;
  for (int step = 0; step < kSteps; ++step) {
    posture_.set(setting, parameters);
    Eigen::VectorXd gap = Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(loops_.size()));
    Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(gap.size(), n);
    Eigen::Index row = 0;
    for (const Loop& loop : loops_) {
      const Eigen::Isometry3d &A = posture_.frame(loop.at), &I = posture_.frame(loop.in);
      const Eigen::AngleAxisd turned(A.linear() * I.linear().transpose());
      if (loop.place) gap.segment<3>(row) = A.translation() - I.translation();
      if (loop.turn) gap.segment<3>(row + 3) = kArm * turned.angle() * turned.axis();
      for (std::size_t i = 0; i < loop.moves.size(); ++i) {
        const JointAxis& axis = posture_.axes()[i];
        const auto& [moves_at, moves_in] = loop.moves[i];
        if (loop.place && moves_at)
          slope.block<3, 1>(row, axis.coordinate) += axis.shift(A.translation());
        if (loop.place && moves_in)
          slope.block<3, 1>(row, axis.coordinate) -= axis.shift(I.translation());
        if (loop.turn && moves_at != moves_in)
          slope.block<3, 1>(row + 3, axis.coordinate) += (moves_at ? kArm : -kArm) * axis.turn();
      }
      row += 6;
    }
    if (!gap.allFinite() || !slope.allFinite()) return false;
    if (gap.cwiseAbs().maxCoeff() < kClosed) return true;
    const Eigen::MatrixXd scaled = slope * size.asDiagonal();
    Eigen::VectorXd move = -scaled.completeOrthogonalDecomposition().solve(gap);
    if (const double most = move.cwiseAbs().maxCoeff(); most > kLargest) move *= kLargest / most;
    for (Eigen::Index i = 0; i < n; ++i)
      if (const auto& c = coordinates[static_cast<std::size_t>(i)]; c.range && size[i] > 0) {
        double& v = setting[static_cast<std::size_t>(i)];
        v = std::clamp(v + size[i] * move[i], c.range->first, c.range->second);
      }
  }
  return false;
}

}  // namespace talus
