// A plan: how to evaluate a program's residual rows, and their exact derivatives by chosen slots,
// for a batch of poses at once (structure of arrays, `lanes` poses side by side, so that every
// operation is a few SIMD instructions).
//
// What is worked out when the plan is made:
//   * nodes that depend on data only (readings, measured columns) are computed once per recording;
//   * nodes that depend on parameters only are computed once per evaluation;
//   * local derivatives (of a motion's amount by the slots, of a row by the end pose) are
//   expressions
//     on the tape like all others, exact and shared.
// Derivatives are chained by adjoints: a residual row is a wrench (f, n) at the end of its chain, a
// motion is a screw axis (w, m) in Pluecker coordinates, and the derivative is w.n + m.f: the cost
// of a column does not depend on the length of the chain.
#pragma once

#include <cstddef>
#include <new>
#include <span>
#include <vector>

#include "framework/kinematics/program.h"
#include "framework/kinematics/tape_values.h"

namespace talus {

inline constexpr int lanes = 16;

template <class T>
struct AlignedAllocator {
  using value_type = T;
  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t n) {
    return static_cast<T*>(::operator new(n * sizeof(T), std::align_val_t(64)));
  }
  void deallocate(T* p, std::size_t) { ::operator delete(p, std::align_val_t(64)); }
  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) { return true; }
};
using Buffer = std::vector<double, AlignedAllocator<double>>;

// What is done to the rows of a pose before the columns are formed (weights, whitening, robust
// corrections, projections): nothing, a factor per row [row][lane], or a matrix [row][row][lane].
struct RowTransform {
  enum class Kind { none, diagonal, dense } kind = Kind::none;
  const double* values = nullptr;
};

class Plan {
 public:
  // `sets`: the slots to differentiate by, in sets that are asked for separately. `state`: the
  // slots that differ from pose to pose but are not data (unknowns, readings to be solved for).
  Plan(const Program& program, std::vector<std::vector<int>> sets, std::vector<int> state);

  int rows() const { return static_cast<int>(row_nodes_.size()); }
  const std::vector<int>& columns(int set) const { return sets_[set]; }
  const std::vector<int>& state() const { return state_; }

  // Data nodes: computed once per recording by the caller, from the slots' values.
  const std::vector<std::int32_t>& data_nodes() const { return data_nodes_; }
  const std::vector<int>& data_slots() const { return data_slots_; }  // the data that the rows need
  TapeValues data_values() const { return data_values_; }  // to compute the data nodes with
  const std::vector<int>& row_slots(int row) const {
    return row_slots_[row];
  }  // all it depends on, through its chain too

  Buffer workspace() const { return Buffer(workspace_size_); }
  // Once per evaluation; `slots` holds the parameters' values at their slots.
  void set_parameters(Buffer& workspace, std::span<const double> slots) const;
  // Once per batch: `data` is [data node][lane], `state` is [state slot][lane].
  void evaluate(Buffer& workspace, const double* data, const double* state) const;
  // After evaluate: lanes of a residual row, and of T_in_at (12 entries) of a chain.
  const double* row(const Buffer& workspace, int row) const { return &workspace[row_nodes_[row]]; }
  const double* pose(const Buffer& workspace, int chain) const;
  // After evaluate: J[column * stride + row * lanes + lane] for the columns of one set.
  void jacobian(Buffer& workspace, int set, const RowTransform& transform, double* J,
                std::size_t stride) const;

 private:
  struct Instruction {
    // The tape's operations, and some of them fused.
    enum class Fused : std::uint8_t {
      none,
      multiply_add,
      multiply_subtract,
      subtract_product,
      sine_and_cosine
    };
    Op op;
    Fused fused = Fused::none;
    std::int32_t out, a, b,
        c;  // offsets into the workspace (sine_and_cosine: the cosine goes to c)
  };
  struct Target {
    int set = -1, column = -1;  // position within the set
  };
  // A column's share of a motion: the derivative by the motion's amount times that of the amount.
  struct Contribution {
    Target to;
    std::int32_t factor;  // offset; -1: one, -2: minus one
    bool first;           // the column's first contribution of all
    std::int32_t
        line;  // offset of the screw axis: [direction, moment] or the translation's direction
    bool translation;
    bool again;  // same axis as the contribution before
  };
  struct Step {
    Motion<Expr>::Kind kind;
    int axis;
    std::int32_t a = -1, b = -1;            // sine and cosine, or the amount
    std::array<std::int32_t, 12> matrix{};  // rotation and translation of a matrix motion
    std::int32_t line = -1;                 // where the axis is kept; -1: not needed
    struct Twist {  // a matrix motion's own axis for one slot, in the frame behind it
      std::array<std::int32_t, 6> parts;  // rotation, translation
      std::int32_t line;
    };
    std::vector<Twist> twists;
  };
  struct ChainPlan {
    std::vector<Step> steps;
    std::vector<std::vector<Contribution>> contributions;  // per column set
    std::int32_t pose = -1;    // 12 lane arrays; -1: no row looks at this chain
    std::int32_t wrench = -1;  // [row][6] after the row transform
    std::vector<char> row_used, row_has_force;
    std::vector<std::array<std::int32_t, 6>> wrench_nodes;  // per row: force, moment; -1 where zero
  };
  struct Direct {
    int row;
    Target to;
    std::int32_t node;
    bool first;
  };

  class Builder;
  static void run(const std::vector<Instruction>& instructions, double* workspace);
  static void forward(const ChainPlan& chain, double* workspace);
  void wrenches(const ChainPlan& chain, const RowTransform& transform, double* workspace) const;
  template <int Rows, bool Force>
  static void fill_columns(const std::vector<Contribution>& list, const double* const* wrench,
                           double* const* out, std::size_t stride, const double* workspace);

  std::vector<std::vector<int>> sets_;
  std::vector<int> state_, data_slots_;
  std::vector<std::vector<int>> row_slots_;
  TapeValues data_values_;
  std::vector<std::int32_t> data_nodes_, row_nodes_;
  std::vector<Instruction> before_, after_;  // the chains
  struct UniformNode {
    Op op;
    std::int32_t out, a, b, c;  // indices into the scalar values
    double value;               // constants
  };
  std::vector<UniformNode> uniform_;
  std::vector<std::pair<std::int32_t, std::int32_t>>
      broadcast_;  // scalar index -> workspace offset
  std::vector<ChainPlan> chains_;
  std::vector<Direct> direct_;
  std::vector<std::vector<char>> touched_;
  std::int32_t data_offset_ = 0, state_offset_ = 0, scalar_offset_ = 0;
  std::size_t workspace_size_ = 0;
};

}  // namespace talus
