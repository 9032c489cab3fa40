// Values of some nodes of a tape, pose after pose: what depends on data alone is computed this way,
// once.
#pragma once

#include <span>
#include <vector>

#include "framework/kinematics/expr.h"

namespace talus {

class TapeValues {
 public:
  TapeValues() = default;
  TapeValues(const Tape& tape, std::vector<std::int32_t> wanted);
  // The wanted nodes' values, in their order, given the slots' values.
  const std::vector<double>& operator()(std::span<const double> slots);

 private:
  struct Step {
    Op op;
    int a, b, c;
    double value;
  };
  std::vector<Step> steps_;
  std::vector<int> wanted_;
  std::vector<double> values_, result_;
};

}  // namespace talus
