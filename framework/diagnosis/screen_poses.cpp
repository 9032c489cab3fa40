#include <Eigen/Eigenvalues>
#include <map>

#include "framework/diagnosis/screen_inside.h"

namespace talus {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

// Freeing all rows of a pose explains w_k^T (I - Q_k Q_k^T)^-1 w_k. What only this pose determines
// of the geometry has no rest and counts for nothing.
std::vector<PoseScore> Screen::poses() const {
  const Inside& in = *in_;
  std::map<int, std::vector<int>> rows;
  for (std::size_t r = 0; r < in.pose.size(); ++r) rows[in.pose[r]].push_back(static_cast<int>(r));
  const double share = 1 - in.taken / std::max<double>(1, static_cast<double>(in.pose.size()));
  std::vector<PoseScore> result;
  for (const auto& [pose, own] : rows) {
    const MatrixXd q = in.Q(own, Eigen::all);
    const VectorXd w = in.rest(own);
    const auto count = static_cast<Index>(own.size());
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(MatrixXd::Identity(count, count) -
                                                        q * q.transpose());
    const VectorXd along = eigen.eigenvectors().transpose() * w;
    double explained = 0, directions = 0;
    for (Index j = 0; j < count; ++j)
      if (eigen.eigenvalues()[j] > 1e-8) {
        explained += along[j] * along[j] / eigen.eigenvalues()[j];
        ++directions;
      }
    PoseScore s{.pose = pose, .freedom = directions * share};
    s.log_p = in.log_p(explained, s.freedom, in.chi2, in.noise_known);
    const double left =
        in.noise_known ? 1
                       : std::max(0.0, in.chi2 - explained) / std::max(1.0, in.freedom - s.freedom);
    s.gain = explained / left;
    result.push_back(s);
  }
  return result;
}

}  // namespace talus
