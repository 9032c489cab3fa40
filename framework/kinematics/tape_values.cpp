#include "framework/kinematics/tape_values.h"

#include <map>

namespace talus {

std::set<std::int32_t> needed_nodes(const Tape& tape, const std::vector<std::int32_t>& wanted) {
  std::set<std::int32_t> needed;
  std::vector<std::int32_t> stack = wanted;
  while (!stack.empty()) {
    const std::int32_t i = stack.back();
    stack.pop_back();
    if (i < 0 || !needed.insert(i).second) continue;
    const Node& n = tape[i];
    if (n.op != Op::leaf && n.op != Op::constant) stack.insert(stack.end(), {n.a, n.b, n.c});
  }
  return needed;
}

TapeValues::TapeValues(const Tape& tape, std::vector<std::int32_t> wanted) {
  std::map<std::int32_t, int> at;
  for (std::int32_t i : needed_nodes(tape, wanted)) {  // arguments stand before their users
    const Node& n = tape[i];
    auto argument = [&](std::int32_t a) { return a >= 0 ? at[a] : 0; };
    const bool leaf = n.op == Op::leaf;
    steps_.push_back({n.op, leaf ? n.a : argument(n.a), leaf ? 0 : argument(n.b),
                      leaf ? 0 : argument(n.c), n.value});
    at[i] = static_cast<int>(steps_.size()) - 1;
  }
  for (std::int32_t i : wanted) wanted_.push_back(at[i]);
  values_.resize(steps_.size());
  result_.resize(wanted_.size());
}

const std::vector<double>& TapeValues::operator()(std::span<const double> slots) {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Step& s = steps_[i];
    values_[i] = s.op == Op::leaf       ? slots[s.a]
                 : s.op == Op::constant ? s.value
                                        : apply(s.op, values_[s.a], values_[s.b], values_[s.c]);
  }
  for (std::size_t i = 0; i < wanted_.size(); ++i) result_[i] = values_[wanted_[i]];
  return result_;
}

}  // namespace talus
