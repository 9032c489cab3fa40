// Values of some nodes of a tape, pose after pose: what depends on data alone is computed this way,
// once.
#pragma once

#include <set>
#include <span>
#include <vector>

#include "framework/kinematics/expr.h"

namespace talus {

// Those that the wanted ones are worked out from, themselves among them; a node's arguments have
// smaller numbers than the node.
std::set<std::int32_t> needed_nodes(const Tape& tape, const std::vector<std::int32_t>& wanted);

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
