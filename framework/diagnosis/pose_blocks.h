// A problem made linear, pose by pose, for fits to any choice of poses and for what such a fit says
// of the poses that it was made from and of those it was not.
//
// Columns are brought to the coordinates in which all poses to fit and the priors together have the
// unit matrix as information, so that what no pose sees does no harm and choices are well
// conditioned. The priors belong to every choice.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "framework/calibration/problem.h"

namespace talus {

class PoseBlocks {
 public:
  // `may`: of each pose, whether fits may use it. `x`: where the problem was made linear.
  PoseBlocks(const Problem& problem, const Problem::Linear& linear, std::span<const double> x,
             const std::vector<bool>& may);

  struct Solution {
    Eigen::VectorXd step;
    Eigen::MatrixXd covariance;
    std::vector<bool> in;
  };
  Solution fit(const std::vector<bool>& in) const;

  int poses() const { return static_cast<int>(blocks_.size()); }
  int directions() const { return static_cast<int>(prior_.rows()); }  // that something tells of
  double freedom(int pose) const { return blocks_[pose].freedom; }    // rows less latent unknowns
  int rows_of(int pose) const { return static_cast<int>(blocks_[pose].r.size()); }
  // Rows at the solution: as they are; squared; squared in units of their covariance as predicted
  // from the other poses (d^2 of outliers.h).
  Eigen::VectorXd rows(const Solution& solution, int pose) const;
  double squares(const Solution& solution, int pose) const;
  double distance2(const Solution& solution, int pose) const;
  // (I - H_kk)^-1/2 e_k of a pose among those fitted: rows with the covariance they had before the
  // fit; their square is d^2. And how many rows' worth it determines of the fit.
  Eigen::VectorXd standardised(const Solution& solution, int pose) const;
  double leverage(const Solution& solution, int pose) const;
  // What the fit to the other poses leaves of this pose's rows.
  Eigen::VectorXd predicted(const Solution& solution, int pose) const;

 private:
  struct Block {
    Eigen::MatrixXd A;  // rows x directions
    Eigen::VectorXd r;
    Eigen::MatrixXd gram;  // A^T A
    Eigen::VectorXd gradient;
    double freedom = 0;
  };
  std::vector<Block> blocks_;
  Eigen::MatrixXd prior_;  // information of the priors, and gradient of theirs
  Eigen::VectorXd prior_gradient_;
};

}  // namespace talus
