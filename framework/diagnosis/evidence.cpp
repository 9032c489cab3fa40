#include "framework/diagnosis/evidence.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace talus {

HeldOut held_out(const Eigen::VectorXd& before, const Eigen::VectorXd& after, double rows_per_pose,
                 std::uint64_t seed) {
  constexpr int draws = 2000;
  HeldOut result;
  const Eigen::Index n = before.size();
  result.poses = static_cast<int>(n);
  if (n == 0 || !(rows_per_pose > 0)) return result;
  auto rms = [&](double mean_square) { return std::sqrt(mean_square / rows_per_pose); };
  result.before = rms(before.mean());
  result.after = rms(after.mean());
  // Gains of a pose are heavy-tailed where it misfits badly: tests are on their signed roots.
  const Eigen::VectorXd gain =
      (before - after).unaryExpr([](double g) { return g < 0 ? -std::sqrt(-g) : std::sqrt(g); });
  const double mean = gain.mean(), spread = std::sqrt((gain.array() - mean).square().sum() /
                                                      std::max<double>(1, n - 1));
  result.z = spread > 0 ? mean / (spread / std::sqrt(static_cast<double>(n))) : 0;
  std::mt19937_64 random(seed);
  int as_large = 0;
  std::vector<double> resampled;
  for (int d = 0; d < draws; ++d) {
    double flipped = 0, drawn = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      flipped += (random() & 1) ? gain[k] : -gain[k];
      drawn += after[static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(n))];
    }
    as_large += flipped >= gain.sum();
    resampled.push_back(rms(drawn / static_cast<double>(n)));
  }
  result.p_value = (as_large + 1.0) / (draws + 1.0);
  std::sort(resampled.begin(), resampled.end());
  result.after_low = resampled[draws / 40];
  result.after_high = resampled[draws - 1 - draws / 40];
  return result;
}

}  // namespace talus
