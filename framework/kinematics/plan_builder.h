// Makes a plan. First (plan.cpp) it records what is wanted: rows, wrenches, axes and their
// derivatives, as expressions. Then (plan_place.cpp) it decides what each node depends on, where
// its lanes are kept, and in which order it is computed.
#pragma once

#include <map>
#include <set>

#include "framework/kinematics/plan.h"

namespace talus {

class Plan::Builder {
 public:
  Builder(const Program& program, Plan& plan);
  void build();

 private:
  enum Class : unsigned char { kConstant = 0, kUniform = 1, kData = 2, kState = 4, kChain = 8 };
  // An instruction that has no lanes yet: nodes instead of offsets.
  struct Pending {
    Instruction::Fused fused;
    std::int32_t node, a, b, c;
  };

  // What is wanted.
  std::int32_t want(const Expr& e);
  void wrenches(int chain);
  void steps(int chain);
  void twists(int chain, int step, const Motion<Expr>& motion);
  void contribute(ChainPlan& chain, Target to, std::int32_t factor, bool translation, int step,
                  int twist);
  bool first(Target to) { return !std::exchange(plan_.touched_[to.set][to.column], 1); }
  static std::map<int, Expr> sorted(const std::unordered_map<std::int32_t, Expr>& g) {
    return {g.begin(), g.end()};
  }

  // Where it goes.
  unsigned char classify(std::int32_t node);
  std::int32_t take(int count);            // offset of fresh lanes
  std::int32_t offset(std::int32_t node);  // the node's lanes
  void sort_by_class();
  void place_data_and_chains();
  void place_uniform();
  std::map<std::int32_t, Pending> fuse(std::set<std::int32_t>& inside);
  void schedule();
  void resolve();

  const Program& program_;
  Tape& tape_;
  Plan& plan_;
  std::vector<Target> target_of_;                  // of each slot
  std::vector<unsigned char> slot_class_, class_;  // of slots, of nodes
  std::set<std::int32_t> wanted_;
  std::set<std::int32_t> uniform_, data_, varying_;  // all that is needed, by class
  std::vector<std::pair<int, int>> owners_;          // of axes until they are placed: step, twist
  std::vector<char> used_;                           // chains that some row looks at
  std::map<std::int32_t, std::int32_t> where_;       // node -> offset
  std::map<std::int32_t, std::int32_t> scalar_;      // uniform node -> index of its scalar
  std::vector<std::int32_t> spare_;                  // lanes of nodes that nobody needs any more
  std::int32_t next_ = 0;
};

}  // namespace talus
