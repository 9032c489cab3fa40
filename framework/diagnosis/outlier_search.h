// The choice of good poses on a problem made linear: a first guess by least trimmed squares, and
// from there to a choice that judges itself the same. The rules are those of outliers.h.
#pragma once

#include <cstdint>
#include <map>
#include <random>
#include <vector>

#include "framework/diagnosis/neighbours.h"
#include "framework/diagnosis/pose_blocks.h"

namespace talus {

// What a fit to some poses says of all.
struct Judged {
  std::vector<bool> out;
  std::vector<double> distance, beyond;
  double scale = 1;
  std::size_t clustered = 0;
  PoseBlocks::Solution solution;
};

class OutlierSearch {
 public:
  // `fitted`: the poses that may be fitted; the others are judged alone.
  OutlierSearch(const PoseBlocks& blocks, const std::vector<bool>& fitted,
                const Neighbours& neighbours, bool noise_known, std::uint64_t seed);

  // From a first guess of the good poses to a choice that judges itself the same.
  Judged settle(std::vector<bool> in) const;
  Judged judge(const std::vector<bool>& in) const;
  std::vector<bool> least_trimmed();

 private:
  double trimmed(const PoseBlocks::Solution& solution, std::vector<bool>& best) const;

  const PoseBlocks& blocks_;
  const std::vector<bool>& fitted_;
  std::vector<int> own_;  // numbers of those to fit
  const Neighbours& neighbours_;
  const bool noise_known_;
  std::mt19937_64 random_;
  std::map<double, double> middle_, decile_, limit_;
};

}  // namespace talus
