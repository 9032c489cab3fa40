// Scalar expressions, recorded on a tape.
//
// Every plugin, written in C++ (as a template on its scalar type) or in Lua, is run once when the
// model is compiled, with Expr as its scalar: its operators record an expression graph. All that
// follows (evaluation in batches of poses, exact derivatives, printed equations) is made from that
// graph, so a plugin costs the same in either language and nothing is differentiated numerically.
//
// Nodes are shared (equal expressions are one node) and folded (0*x, 1*x, x+0, constants).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace talus {

enum class Op : std::uint8_t {
  constant,  // value
  leaf,      // the slot numbered `a`
  add,
  sub,
  mul,
  div,
  neg,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan2,
  sqrt,
  exp,
  log,
  abs,
  sign,
  less,    // 1 where a < b, else 0; derivative 0
  select,  // b where a != 0, else c
  floor,   // derivative 0
};

struct Node {
  Op op = Op::constant;
  std::int32_t a = -1, b = -1, c = -1;  // arguments: indices of nodes (leaf: a is the slot)
  double value = 0;
  friend bool operator==(const Node&, const Node&) = default;
};

// The operation on plain numbers (arguments it does not take are ignored).
double apply(Op op, double a, double b, double c);

// Grows only; arguments stand before the nodes that use them.
class Tape {
 public:
  std::int32_t add(const Node& node);
  const Node& operator[](std::int32_t i) const { return nodes_[i]; }
  std::int32_t size() const { return static_cast<std::int32_t>(nodes_.size()); }
  // A node's value where all its leaves have known values.
  double evaluate(std::int32_t node, std::span<const double> slots) const;

 private:
  struct Hash {
    std::size_t operator()(const Node& node) const;
  };
  std::vector<Node> nodes_;
  std::unordered_map<Node, std::int32_t, Hash> index_;
};

// A scalar: a plain constant until it meets a leaf of some tape.
class Expr {
 public:
  Expr(double constant = 0) : value_(constant) {}
  Expr(Tape* tape, std::int32_t node);
  static Expr leaf(Tape& tape, std::int32_t slot);

  bool is_constant() const { return tape_ == nullptr; }
  double constant() const { return value_; }
  Tape* tape() const { return tape_; }
  std::int32_t node() const { return node_; }  // only where not constant
  std::int32_t node_on(Tape& tape) const;      // records a constant where needed
  bool same(const Expr& other) const;

 private:
  Tape* tape_ = nullptr;
  std::int32_t node_ = -1;
  double value_ = 0;
};

// Records op(a, b, c), folding what can be folded.
Expr record(Op op, const Expr& a, const Expr& b = {}, const Expr& c = {});

inline Expr operator+(const Expr& a, const Expr& b) { return record(Op::add, a, b); }
inline Expr operator-(const Expr& a, const Expr& b) { return record(Op::sub, a, b); }
inline Expr operator*(const Expr& a, const Expr& b) { return record(Op::mul, a, b); }
inline Expr operator/(const Expr& a, const Expr& b) { return record(Op::div, a, b); }
inline Expr operator-(const Expr& a) { return record(Op::neg, a); }
inline Expr& operator+=(Expr& a, const Expr& b) { return a = a + b; }
inline Expr& operator-=(Expr& a, const Expr& b) { return a = a - b; }
inline Expr& operator*=(Expr& a, const Expr& b) { return a = a * b; }
inline Expr sin(const Expr& a) { return record(Op::sin, a); }
inline Expr cos(const Expr& a) { return record(Op::cos, a); }
inline Expr tan(const Expr& a) { return record(Op::tan, a); }
inline Expr asin(const Expr& a) { return record(Op::asin, a); }
inline Expr acos(const Expr& a) { return record(Op::acos, a); }
inline Expr atan2(const Expr& y, const Expr& x) { return record(Op::atan2, y, x); }
inline Expr sqrt(const Expr& a) { return record(Op::sqrt, a); }
inline Expr exp(const Expr& a) { return record(Op::exp, a); }
inline Expr log(const Expr& a) { return record(Op::log, a); }
inline Expr abs(const Expr& a) { return record(Op::abs, a); }
inline Expr sign(const Expr& a) { return record(Op::sign, a); }
inline Expr floor(const Expr& a) { return record(Op::floor, a); }
inline Expr less(const Expr& a, const Expr& b) { return record(Op::less, a, b); }
inline Expr select(const Expr& condition, const Expr& a, const Expr& b) {
  return record(Op::select, condition, a, b);
}

// For plain numbers the tracing functions mean themselves.
inline double less(double a, double b) { return a < b ? 1 : 0; }
inline double select(double condition, double a, double b) { return condition != 0 ? a : b; }
inline double sign(double a) { return a > 0 ? 1 : a < 0 ? -1 : 0; }

// Exact partial derivatives of `y` by every slot it depends on (reverse accumulation, recorded on
// the same tape).
std::unordered_map<std::int32_t, Expr> gradient(const Expr& y);

// The slots that `y` depends on, in increasing order.
std::vector<std::int32_t> support(const Expr& y);

// "sin(slot0) * slot1 + 2": for teaching, docs and error messages.
std::string formula(const Expr& y, std::span<const std::string> slot_names);

}  // namespace talus
