#include "framework/kinematics/expr.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <set>

namespace talus {
double apply(Op op, double a, double b, double c) {
  switch (op) {
    case Op::constant:
    case Op::leaf:
      return a;
    case Op::add:
      return a + b;
    case Op::sub:
      return a - b;
    case Op::mul:
      return a * b;
    case Op::div:
      return a / b;
    case Op::neg:
      return -a;
    case Op::sin:
      return std::sin(a);
    case Op::cos:
      return std::cos(a);
    case Op::tan:
      return std::tan(a);
    case Op::asin:
      return std::asin(a);
    case Op::acos:
      return std::acos(a);
    case Op::atan2:
      return std::atan2(a, b);
    case Op::sqrt:
      return std::sqrt(a);
    case Op::exp:
      return std::exp(a);
    case Op::log:
      return std::log(a);
    case Op::abs:
      return std::abs(a);
    case Op::sign:
      return a > 0 ? 1 : a < 0 ? -1 : 0;
    case Op::less:
      return a < b ? 1 : 0;
    case Op::select:
      return a != 0 ? b : c;
    case Op::floor:
      return std::floor(a);
  }
  return 0;
}

namespace {

bool is(const Expr& e, double value) { return e.is_constant() && e.constant() == value; }

Expr argument(const Expr& y, std::int32_t node) {
  const Node& n = (*y.tape())[node];
  return n.op == Op::constant ? Expr(n.value) : Expr(y.tape(), node);
}

}  // namespace

std::size_t Tape::Hash::operator()(const Node& n) const {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &n.value, sizeof bits);
  std::uint64_t h = bits * 0x9E3779B97F4A7C15ull;
  for (std::int64_t part :
       {std::int64_t(n.op), std::int64_t(n.a), std::int64_t(n.b), std::int64_t(n.c)})
    h = (h ^ static_cast<std::uint64_t>(part + 0x7F4A7C15)) * 0xBF58476D1CE4E5B9ull;
  return static_cast<std::size_t>(h ^ (h >> 31));
}

std::int32_t Tape::add(const Node& node) {
  auto [it, fresh] = index_.try_emplace(node, size());
  if (fresh) nodes_.push_back(node);
  return it->second;
}

double Tape::evaluate(std::int32_t node, std::span<const double> slots) const {
  std::unordered_map<std::int32_t, double> known;
  std::function<double(std::int32_t)> value = [&](std::int32_t i) {
    if (i < 0) return 0.0;
    if (auto it = known.find(i); it != known.end()) return it->second;
    const Node& n = nodes_[i];
    double v = n.op == Op::constant ? n.value
               : n.op == Op::leaf   ? slots[n.a]
                                    : apply(n.op, value(n.a), value(n.b), value(n.c));
    return known[i] = v;
  };
  return value(node);
}

Expr::Expr(Tape* tape, std::int32_t node) : tape_(tape), node_(node) {}

Expr Expr::leaf(Tape& tape, std::int32_t slot) {
  return Expr(&tape, tape.add({.op = Op::leaf, .a = slot}));
}

std::int32_t Expr::node_on(Tape& tape) const {
  return is_constant() ? tape.add({.op = Op::constant, .value = value_}) : node_;
}

bool Expr::same(const Expr& other) const {
  return is_constant() ? is(other, value_) : tape_ == other.tape_ && node_ == other.node_;
}

Expr record(Op op, const Expr& a, const Expr& b, const Expr& c) {
  if (a.is_constant() && b.is_constant() && c.is_constant())
    return apply(op, a.constant(), b.constant(), c.constant());
  switch (op) {
    case Op::add:
      if (is(a, 0)) return b;
      if (is(b, 0)) return a;
      break;
    case Op::sub:
      if (is(b, 0)) return a;
      if (is(a, 0)) return -b;
      if (a.same(b)) return 0;
      break;
    case Op::mul:
      if (is(a, 0) || is(b, 0)) return 0;
      if (is(a, 1)) return b;
      if (is(b, 1)) return a;
      if (is(a, -1)) return -b;
      if (is(b, -1)) return -a;
      break;
    case Op::div:
      if (is(a, 0)) return 0;
      if (is(b, 1)) return a;
      break;
    case Op::neg:
      if (const Node& n = (*a.tape())[a.node()]; n.op == Op::neg) return argument(a, n.a);
      break;
    case Op::select:
      if (a.is_constant()) return a.constant() != 0 ? b : c;
      if (b.same(c)) return b;
      break;
    default:
      break;
  }
  Tape* tape = a.tape() ? a.tape() : b.tape() ? b.tape() : c.tape();
  Node node{.op = op, .a = a.node_on(*tape)};
  bool two = op == Op::add || op == Op::sub || op == Op::mul || op == Op::div || op == Op::atan2 ||
             op == Op::less || op == Op::select;
  if (two) node.b = b.node_on(*tape);
  if (op == Op::select) node.c = c.node_on(*tape);
  if ((op == Op::add || op == Op::mul) && node.a > node.b) std::swap(node.a, node.b);
  return Expr(tape, tape->add(node));
}

std::unordered_map<std::int32_t, Expr> gradient(const Expr& y) {
  std::unordered_map<std::int32_t, Expr> by_slot;
  if (y.is_constant()) return by_slot;
  Tape& tape = *y.tape();
  std::set<std::int32_t, std::greater<>> pending{y.node()};  // arguments come later: reverse order
  std::unordered_map<std::int32_t, Expr> adjoint{{y.node(), Expr(1.0)}};
  auto feed = [&](std::int32_t node, const Expr& amount) {
    if (tape[node].op == Op::constant || is(amount, 0)) return;
    adjoint[node] += amount;
    pending.insert(node);
  };
  while (!pending.empty()) {
    std::int32_t i = *pending.begin();
    pending.erase(pending.begin());
    const Node n = tape[i];
    const Expr self(&tape, i), w = adjoint[i];
    if (n.op == Op::leaf) {
      by_slot[n.a] = w;
      continue;
    }
    const Expr a = argument(self, n.a);
    const Expr b = n.b >= 0 ? argument(self, n.b) : Expr();
    switch (n.op) {
      case Op::add:
        feed(n.a, w), feed(n.b, w);
        break;
      case Op::sub:
        feed(n.a, w), feed(n.b, -w);
        break;
      case Op::mul:
        feed(n.a, w * b), feed(n.b, w * a);
        break;
      case Op::div:
        feed(n.a, w / b), feed(n.b, -(w * self / b));
        break;
      case Op::neg:
        feed(n.a, -w);
        break;
      case Op::sin:
        feed(n.a, w * cos(a));
        break;
      case Op::cos:
        feed(n.a, -(w * sin(a)));
        break;
      case Op::tan:
        feed(n.a, w * (1 + self * self));
        break;
      case Op::asin:
        feed(n.a, w / sqrt(1 - a * a));
        break;
      case Op::acos:
        feed(n.a, -(w / sqrt(1 - a * a)));
        break;
      case Op::atan2: {
        const Expr scale = w / (a * a + b * b);
        feed(n.a, scale * b), feed(n.b, -(scale * a));
        break;
      }
      case Op::sqrt:
        feed(n.a, w / (2 * self));
        break;
      case Op::exp:
        feed(n.a, w * self);
        break;
      case Op::log:
        feed(n.a, w / a);
        break;
      case Op::abs:
        feed(n.a, w * sign(a));
        break;
      case Op::select:
        feed(n.b, select(a, w, 0)), feed(n.c, select(a, 0, w));
        break;
      case Op::constant:
      case Op::leaf:
      case Op::sign:
      case Op::less:
      case Op::floor:
        break;
    }
  }
  return by_slot;
}

std::vector<std::int32_t> support(const Expr& y) {
  std::set<std::int32_t> slots, seen;
  std::vector<std::int32_t> stack;
  if (!y.is_constant()) stack.push_back(y.node());
  while (!stack.empty()) {
    std::int32_t i = stack.back();
    stack.pop_back();
    if (i < 0 || !seen.insert(i).second) continue;
    const Node& n = (*y.tape())[i];
    if (n.op == Op::leaf)
      slots.insert(n.a);
    else
      stack.insert(stack.end(), {n.a, n.b, n.c});
  }
  return {slots.begin(), slots.end()};
}

std::string formula(const Expr& y, std::span<const std::string> names) {
  static constexpr const char* function[] = {
      "",     "",      "",     "",    "",    "",    "",     "sin",  "cos",    "tan",  "asin",
      "acos", "atan2", "sqrt", "exp", "log", "abs", "sign", "less", "select", "floor"};
  // Precedence: 1 sums, 2 products, 3 unary minus, 4 atoms.
  std::function<std::string(std::int32_t, int)> write = [&](std::int32_t i,
                                                            int outer) -> std::string {
    const Node& n = (*y.tape())[i];
    auto wrap = [&](int own, std::string text) { return own < outer ? "(" + text + ")" : text; };
    switch (n.op) {
      case Op::constant:
        return wrap(n.value < 0 ? 3 : 4, fmt::format("{}", n.value));
      case Op::leaf:
        return names[n.a];
      case Op::add:
        return wrap(1, write(n.a, 1) + " + " + write(n.b, 1));
      case Op::sub:
        return wrap(1, write(n.a, 1) + " - " + write(n.b, 2));
      case Op::mul:
        return wrap(2, write(n.a, 2) + " * " + write(n.b, 2));
      case Op::div:
        return wrap(2, write(n.a, 2) + " / " + write(n.b, 3));
      case Op::neg:
        return wrap(2, "-" + write(n.a, 3));
      default:
        break;
    }
    std::string text = function[static_cast<int>(n.op)] + ("(" + write(n.a, 0));
    if (n.b >= 0) text += ", " + write(n.b, 0);
    if (n.c >= 0) text += ", " + write(n.c, 0);
    return text + ")";
  };
  return y.is_constant() ? fmt::format("{}", y.constant()) : write(y.node(), 0);
}

}  // namespace talus
