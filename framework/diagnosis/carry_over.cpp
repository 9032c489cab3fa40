#include "framework/diagnosis/carry_over.h"

#include <algorithm>
#include <limits>

#include "framework/diagnosis/evidence.h"

namespace talus {
namespace {

constexpr int kFolds = 5, kRuns = 2;  // runs of neighbours in each fold
constexpr double kAlpha = 0.01;

}  // namespace

CarryOver::CarryOver(const Ground& ground) : ground_(&ground), folds_(kFolds) {
  std::vector<std::size_t> rows = ground.rows;
  if (const RecordedColumn* pose = ground.recordings->find("pose"))
    std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
      return pose->values[a] < pose->values[b];
    });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t run = i * kFolds * kRuns / rows.size();
    for (std::size_t f = 0; f < kFolds; ++f)
      (run % kFolds == f ? folds_[f].check : folds_[f].fit).push_back(rows[i]);
  }
  for (Split& fold : folds_) {
    std::sort(fold.fit.begin(), fold.fit.end());
    std::sort(fold.check.begin(), fold.check.end());
  }
}

Eigen::VectorXd CarryOver::predicted(const Trial& trial) const {
  FitOptions options;
  options.threads = ground_->threads;
  options.restarts = 0;
  options.max_iterations = 60;
  options.start = trial.x;
  std::vector<double> squares;
  for (const Split& fold : folds_) {
    const Fit fit = calibrate(*trial.program, *ground_->recordings, fold, options);
    for (Eigen::Index k = 0; k < fit.residuals_check.whitened.rows(); ++k)
      squares.push_back(fit.residuals_check.whitened.row(k).squaredNorm());
  }
  return Eigen::Map<Eigen::VectorXd>(squares.data(), static_cast<Eigen::Index>(squares.size()));
}

bool CarryOver::better(const Eigen::VectorXd& more, const Eigen::VectorXd& less) {
  if (more.size() != less.size() || more.size() == 0) return true;  // nothing can be said
  if (!(more.sum() < less.sum())) return false;
  return held_out(less, more, 1, 1).p_value <= kAlpha;
}

}  // namespace talus
