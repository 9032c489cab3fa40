// What rows held out say: how much better they are predicted, with an interval, and how likely
// chance would do as much.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace talus {

struct HeldOut {
  int poses = 0;
  double before = 0, after = 0;          // root mean squares in sigmas
  double after_low = 0, after_high = 0;  // 95 % of `after`, poses drawn anew
  double z = 0;                          // mean gain per pose over its standard error
  double p_value = 1;                    // sign-flip test of the gains, one-sided
};

// Squares of each pose's whitened rows before and after; rows per pose that they are over.
HeldOut held_out(const Eigen::VectorXd& before, const Eigen::VectorXd& after, double rows_per_pose,
                 std::uint64_t seed);

}  // namespace talus
