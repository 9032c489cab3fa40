#include "framework/diagnosis/curve_evidence.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace talus {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

constexpr double kReach = 10;      // usual sizes: heights of a free curve, as where it is fitted
constexpr double kVisible = 0.05;  // sigmas: pieces of a curve that show less say nothing

}  // namespace

CurveEvidence in_cells(const CurveEvidence& e, int most) {
  if (e.x.size() <= most) return e;
  const double low = e.x.minCoeff(), width = (e.x.maxCoeff() - low) / most;
  std::vector<int> cell(static_cast<std::size_t>(most), -1);
  std::vector<Index> of(static_cast<std::size_t>(e.x.size()));
  int count = 0;
  for (Index k = 0; k < e.x.size(); ++k) {
    const auto c = static_cast<std::size_t>(std::min<double>(most - 1, (e.x[k] - low) / width));
    if (cell[c] < 0) cell[c] = count++;
    of[static_cast<std::size_t>(k)] = cell[c];
  }
  CurveEvidence r = e;
  r.x = r.weight = r.wanted = VectorXd::Zero(count);
  r.absorbed = MatrixXd::Zero(e.absorbed.rows(), count);
  for (MatrixXd& curve : r.curves) curve = MatrixXd::Zero(count, curve.cols());
  VectorXd poses = VectorXd::Zero(count);
  for (Index k = 0; k < e.x.size(); ++k) {
    const Index c = of[static_cast<std::size_t>(k)];
    poses[c] += 1, r.x[c] += e.x[k];
    r.weight[c] += e.weight[k], r.wanted[c] += e.wanted[k];
    r.absorbed.col(c) += e.absorbed.col(k);
    for (std::size_t i = 0; i < r.curves.size(); ++i) r.curves[i].row(c) += e.curves[i].row(k);
  }
  r.x = r.x.cwiseQuotient(poses);
  for (MatrixXd& curve : r.curves) curve = poses.cwiseInverse().asDiagonal() * curve;
  return r;
}

MatrixXd weighed(const CurveEvidence& e, const MatrixXd& phi) {
  MatrixXd y = -e.absorbed.transpose() * (e.absorbed * phi);
  y += e.weight.asDiagonal() * phi;
  return y;
}

std::pair<double, int> curve_gain(const CurveEvidence& e, const MatrixXd& curve,
                                  const MatrixXd* beside) {
  const double reach = kReach * e.typical;
  MatrixXd A = curve.transpose() * weighed(e, curve) * reach * reach;
  VectorXd b = curve.transpose() * e.wanted * reach;
  if (beside) {
    const MatrixXd KP = weighed(e, *beside), C = KP.transpose() * curve * reach;
    MatrixXd own = beside->transpose() * KP;
    own.diagonal() *= 1 + 1e-10;  // terms may be nearly the same
    const Eigen::LDLT<MatrixXd> inner(own);
    A -= C.transpose() * inner.solve(C);
    b -= C.transpose() * inner.solve(beside->transpose() * e.wanted);
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen((A + A.transpose()) / 2);
  const VectorXd z = eigen.eigenvectors().transpose() * b;
  double gain = 0;
  int seen = 0;
  for (Index i = 0; i < z.size(); ++i) {
    const double s2 = eigen.eigenvalues()[i];
    if (s2 < std::max(kVisible * kVisible, 1e-10 * eigen.eigenvalues().maxCoeff())) continue;
    gain += z[i] * z[i] / (1 + s2), ++seen;
  }
  return {gain, seen};
}

}  // namespace talus
