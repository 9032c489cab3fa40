#include "framework/diagnosis/pose_blocks.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace talus {
namespace {

// What is smaller than this share of the largest is rounding.
constexpr double rounding = 1e-12;
// A direction of a pose of which the other poses tell less than this share has nothing to be
// compared with.
constexpr double told_by_others = 1e-6;

}  // namespace

PoseBlocks::PoseBlocks(const Problem& problem, const Problem::Linear& linear,
                       std::span<const double> x, const std::vector<bool>& may) {
  const auto n = linear.columns.cols();
  const double weight = problem.noise_variance();
  Eigen::VectorXd information = Eigen::VectorXd::Zero(n), pull = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i)
    if (const Quantity& q = problem.quantity(static_cast<int>(i)); q.tolerance) {
      information[i] = weight / (*q.tolerance * *q.tolerance);
      pull[i] = information[i] * (x[i] - q.value);
    }
  // Total information, columns scaled to one; its eigenvectors are the new coordinates.
  Eigen::MatrixXd H = information.asDiagonal();
  std::vector<std::pair<Eigen::Index, Eigen::Index>> range;  // first row and count of each pose
  for (std::size_t row = 0; row < linear.pose.size(); ++row) {
    if (range.empty() || linear.pose[row] != linear.pose[row - 1]) range.push_back({row, 0});
    ++range.back().second;
  }
  for (std::size_t k = 0; k < range.size(); ++k)
    if (may[k]) {
      const auto J = linear.columns.middleRows(range[k].first, range[k].second);
      H.noalias() += J.transpose() * J;
    }
  const Eigen::VectorXd scale =
      H.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0; });
  H = scale.asDiagonal() * H * scale.asDiagonal();
  Eigen::MatrixXd basis(n, 0);
  if (n > 0) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(H);
    const Eigen::VectorXd& value = solver.eigenvalues();
    Eigen::Index first = 0;
    while (first < n && !(value[first] > rounding * value[n - 1])) ++first;
    basis = scale.asDiagonal() * solver.eigenvectors().rightCols(n - first) *
            value.tail(n - first).cwiseSqrt().cwiseInverse().asDiagonal();
  }
  prior_ = basis.transpose() * information.asDiagonal() * basis;
  prior_gradient_ = basis.transpose() * pull;
  for (const auto& [start, count] : range) {
    Block b;
    b.A = linear.columns.middleRows(start, count) * basis;
    b.r = linear.rows.segment(start, count);
    b.gram = b.A.transpose() * b.A;
    b.gradient = b.A.transpose() * b.r;
    const auto told = (b.r.array() != 0).count();  // missing and dependent rows are zero
    b.freedom = std::max<double>(0, static_cast<double>(told) - problem.latents());
    blocks_.push_back(std::move(b));
  }
}

PoseBlocks::Solution PoseBlocks::fit(const std::vector<bool>& in) const {
  Eigen::MatrixXd H = prior_;
  Eigen::VectorXd g = prior_gradient_;
  for (int k = 0; k < poses(); ++k)
    if (in[k]) H += blocks_[k].gram, g += blocks_[k].gradient;
  Solution s{Eigen::VectorXd(H.rows()), H, in};
  if (H.rows() == 0) return s;
  H.diagonal().array() += rounding;  // what these poses do not see stays where it is
  const Eigen::LLT<Eigen::MatrixXd> solver(H);
  s.covariance = solver.solve(Eigen::MatrixXd::Identity(H.rows(), H.cols()));
  s.step = -solver.solve(g);
  return s;
}

Eigen::VectorXd PoseBlocks::rows(const Solution& s, int pose) const {
  return blocks_[pose].r + blocks_[pose].A * s.step;
}

double PoseBlocks::squares(const Solution& s, int pose) const {
  return rows(s, pose).squaredNorm();
}

// The covariance of the rows is I - H_kk where the pose is among those fitted, I + H_kk otherwise.
double PoseBlocks::distance2(const Solution& s, int pose) const {
  const Block& b = blocks_[pose];
  Eigen::MatrixXd C = b.A * s.covariance * b.A.transpose();
  if (s.in[pose]) C = -C;
  C.diagonal().array() += 1;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(C);
  const Eigen::VectorXd along = solver.eigenvectors().transpose() * rows(s, pose);
  double sum = 0;
  for (Eigen::Index i = 0; i < along.size(); ++i)
    if (solver.eigenvalues()[i] > told_by_others)
      sum += along[i] * along[i] / solver.eigenvalues()[i];
  return sum;
}

Eigen::VectorXd PoseBlocks::standardised(const Solution& s, int pose) const {
  const Block& b = blocks_[pose];
  Eigen::MatrixXd C = -(b.A * s.covariance * b.A.transpose());
  C.diagonal().array() += 1;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(C);
  Eigen::VectorXd along = solver.eigenvectors().transpose() * rows(s, pose);
  for (Eigen::Index i = 0; i < along.size(); ++i)
    along[i] = solver.eigenvalues()[i] > told_by_others
                   ? along[i] / std::sqrt(solver.eigenvalues()[i])
                   : 0;
  return solver.eigenvectors() * along;
}

double PoseBlocks::leverage(const Solution& s, int pose) const {
  return (blocks_[pose].gram * s.covariance).trace();
}

Eigen::VectorXd PoseBlocks::predicted(const Solution& s, int pose) const {
  if (!s.in[pose]) return rows(s, pose);
  const Block& b = blocks_[pose];
  Eigen::MatrixXd C = -(b.A * s.covariance * b.A.transpose());
  C.diagonal().array() += 1 + 1e-9;
  return C.ldlt().solve(rows(s, pose));
}

}  // namespace talus
