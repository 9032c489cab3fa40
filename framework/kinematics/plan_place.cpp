#include <algorithm>
#include <tuple>

#include "framework/kinematics/plan_builder.h"

namespace talus {

unsigned char Plan::Builder::classify(std::int32_t i) {
  if (i < 0) return kConstant;
  if (static_cast<std::size_t>(i) >= class_.size()) class_.resize(tape_.size(), 0xFF);
  if (class_[i] != 0xFF) return class_[i];
  const Node& n = tape_[i];
  unsigned char result =
      n.op == Op::constant ? 0u + kConstant
      : n.op == Op::leaf
          ? slot_class_[n.a]
          : static_cast<unsigned char>(classify(n.a) | classify(n.b) | classify(n.c));
  return class_[i] = result;
}

std::int32_t Plan::Builder::take(int count) {
  const std::int32_t offset = next_;
  next_ += count * lanes;
  return offset;
}

std::int32_t Plan::Builder::offset(std::int32_t node) {
  if (node < 0) return 0;
  auto [it, fresh] = where_.try_emplace(node, 0);
  if (fresh) {
    const bool uniform = uniform_.contains(node), reuse = !spare_.empty() && !uniform;
    it->second = reuse ? spare_.back() : take(1);
    if (reuse) spare_.pop_back();
    if (uniform) plan_.broadcast_.emplace_back(scalar_[node], it->second);
  }
  return it->second;
}

void Plan::Builder::sort_by_class() {
  std::vector<std::int32_t> stack(wanted_.begin(), wanted_.end());
  while (!stack.empty()) {
    const std::int32_t i = stack.back();
    stack.pop_back();
    if (i < 0) continue;
    const unsigned char k = classify(i);
    auto& set = k <= kUniform ? uniform_ : k == kData ? data_ : varying_;
    if (!set.insert(i).second || k == kData) continue;
    const Node& n = tape_[i];
    if (n.op != Op::leaf && n.op != Op::constant) stack.insert(stack.end(), {n.a, n.b, n.c});
  }
}

void Plan::Builder::place_data_and_chains() {
  plan_.data_nodes_.assign(data_.begin(), data_.end());
  plan_.data_offset_ = take(static_cast<int>(data_.size()));
  for (std::size_t i = 0; i < plan_.data_nodes_.size(); ++i)
    where_[plan_.data_nodes_[i]] = plan_.data_offset_ + static_cast<int>(i) * lanes;
  std::set<int> slots;
  for (std::int32_t node : plan_.data_nodes_)
    for (int slot : support(Expr(&tape_, node))) slots.insert(slot);
  plan_.data_slots_.assign(slots.begin(), slots.end());
  plan_.data_values_ = TapeValues(tape_, plan_.data_nodes_);
  plan_.row_slots_ = row_support(program_);

  plan_.state_offset_ = take(static_cast<int>(plan_.state_.size()));
  for (std::size_t c = 0; c < plan_.chains_.size(); ++c) {
    ChainPlan& chain = plan_.chains_[c];
    if (!used_[c]) continue;
    chain.pose = take(12);
    chain.wrench = take(6 * static_cast<int>(program_.rows.size()));
    for (Step& s : chain.steps) {
      if (s.line >= 0) s.line = take(s.kind == Motion<Expr>::Kind::translation ? 3 : 6);
      for (Step::Twist& t : s.twists) t.line = take(6);
    }
    for (auto& list : chain.contributions) {
      std::int32_t last = -1;
      for (Contribution& k : list) {
        const auto [step, twist] = owners_[k.line];
        k.line = twist < 0 ? chain.steps[step].line : chain.steps[step].twists[twist].line;
        k.again = k.line == last;
        last = k.line;
      }
    }
  }
  // Leaves that are neither data nor parameters.
  for (std::int32_t i : varying_) {
    const Node& n = tape_[i];
    if (n.op != Op::leaf) continue;
    if (slot_class_[n.a] == kState) {
      const auto s =
          std::find(plan_.state_.begin(), plan_.state_.end(), n.a) - plan_.state_.begin();
      where_[i] = plan_.state_offset_ + static_cast<int>(s) * lanes;
    } else {
      for (std::size_t c = 0; c < program_.chains.size(); ++c)
        if (int k = n.a - program_.chains[c].first_slot; k >= 0 && k < 12)
          where_[i] = plan_.chains_[c].pose + k * lanes;
    }
  }
}

// Scalars; those that are used beside varying nodes get lanes when asked for.
void Plan::Builder::place_uniform() {
  for (std::int32_t i : uniform_) {
    const Node& n = tape_[i];
    const auto out = static_cast<std::int32_t>(scalar_.size());
    auto arg = [&](std::int32_t a) { return a >= 0 ? scalar_[a] : -1; };
    if (n.op == Op::leaf)
      plan_.uniform_.push_back({n.op, out, n.a, -1, -1, 0});
    else
      plan_.uniform_.push_back({n.op, out, arg(n.a), arg(n.b), arg(n.c), n.value});
    scalar_[i] = out;
  }
}

// Products that are used once, by a sum, and sines beside cosines become one instruction; `inside`
// receives the nodes that are then done within another's.
std::map<std::int32_t, Plan::Builder::Pending> Plan::Builder::fuse(std::set<std::int32_t>& inside) {
  using Fused = Instruction::Fused;
  std::map<std::int32_t, Pending> fused;
  std::map<std::int32_t, int> uses;
  std::map<std::int32_t, std::int32_t> cosine_of;  // argument -> cosine
  for (std::int32_t i : varying_) {
    const Node& n = tape_[i];
    if (n.op == Op::leaf) continue;
    for (std::int32_t a : {n.a, n.b, n.c})
      if (a >= 0) ++uses[a];
    if (n.op == Op::cos) cosine_of[n.a] = i;
  }
  auto product = [&](std::int32_t i) {
    return tape_[i].op == Op::mul && varying_.contains(i) && !wanted_.contains(i) && uses[i] == 1;
  };
  for (std::int32_t i : varying_) {
    const Node& n = tape_[i];
    if ((n.op == Op::add || n.op == Op::sub) && product(n.b)) {
      const Node& m = tape_[n.b];
      fused[i] = {n.op == Op::add ? Fused::multiply_add : Fused::subtract_product, i, m.a, m.b,
                  n.a};
      inside.insert(n.b);
    } else if ((n.op == Op::add || n.op == Op::sub) && product(n.a)) {
      const Node& m = tape_[n.a];
      fused[i] = {n.op == Op::add ? Fused::multiply_add : Fused::multiply_subtract, i, m.a, m.b,
                  n.b};
      inside.insert(n.a);
    } else if (n.op == Op::sin && cosine_of.contains(n.a) && cosine_of[n.a] > i) {
      fused[i] = {Fused::sine_and_cosine, i, n.a, -1, cosine_of[n.a]};
      inside.insert(cosine_of[n.a]);
    }
  }
  return fused;
}

// Instructions before and after the chains. Independent ones of one kind stand together: the
// interpreter then runs them without branching. Lanes are given out in that order and taken back
// after a node's last use.
void Plan::Builder::schedule() {
  std::set<std::int32_t> inside;
  const std::map<std::int32_t, Pending> fused = fuse(inside);
  std::array<std::vector<Pending>, 2> pending;
  for (std::int32_t i : varying_) {
    const Node& n = tape_[i];
    if (n.op == Op::leaf || inside.contains(i)) continue;
    const auto f = fused.find(i);
    pending[classify(i) & kChain ? 1 : 0].push_back(
        f != fused.end() ? f->second : Pending{Instruction::Fused::none, i, n.a, n.b, n.c});
  }
  std::map<std::int32_t, int> depth;
  std::map<std::int32_t, const Pending*> last_use;
  for (auto& list : pending) {
    for (const Pending& k : list) {
      const bool two_results = k.fused == Instruction::Fused::sine_and_cosine;
      int d = 0;
      for (std::int32_t a : {k.a, k.b, two_results ? -1 : k.c})
        if (a >= 0) d = std::max(d, depth[a] + 1);
      depth[k.node] = d;
      if (two_results) depth[k.c] = d;
    }
    std::stable_sort(list.begin(), list.end(), [&](const Pending& x, const Pending& y) {
      return std::tuple(depth[x.node], x.fused, tape_[x.node].op) <
             std::tuple(depth[y.node], y.fused, tape_[y.node].op);
    });
    for (const Pending& k : list)
      for (std::int32_t a : {k.a, k.b, k.c}) last_use[a] = &k;
  }
  for (int stage = 0; stage < 2; ++stage)
    for (const Pending& k : pending[stage]) {
      const std::int32_t a = offset(k.a), b = offset(k.b), c = offset(k.c);
      (stage ? plan_.after_ : plan_.before_)
          .push_back({tape_[k.node].op, k.fused, offset(k.node), a, b, c});
      for (std::int32_t i : std::set<std::int32_t>{k.a, k.b, k.c})
        if (i >= 0 && last_use[i] == &k && varying_.contains(i) && tape_[i].op != Op::leaf &&
            !wanted_.contains(i))
          spare_.push_back(where_[i]);
    }
}

// Nodes become offsets in all that the inner loops look at.
void Plan::Builder::resolve() {
  auto fix = [&](std::int32_t& node) { node = offset(node); };
  for (const Row& row : program_.rows) plan_.row_nodes_.push_back(offset(row.value.node_on(tape_)));
  for (ChainPlan& chain : plan_.chains_) {
    for (auto& nodes : chain.wrench_nodes)
      for (auto& node : nodes)
        if (node >= 0) fix(node);
    for (Step& s : chain.steps) {
      if (s.kind == Motion<Expr>::Kind::matrix) {
        for (auto& node : s.matrix) fix(node);
      } else {
        fix(s.a);
        if (s.kind == Motion<Expr>::Kind::rotation) fix(s.b);
      }
      for (Step::Twist& t : s.twists)
        for (auto& node : t.parts) fix(node);
    }
    for (auto& list : chain.contributions)
      for (Contribution& k : list)
        if (k.factor >= 0) fix(k.factor);
  }
  for (Direct& d : plan_.direct_) {
    fix(d.node);
    d.first = first(d.to);
  }
  plan_.scalar_offset_ = next_;
  plan_.workspace_size_ = static_cast<std::size_t>(next_) + scalar_.size();
}

}  // namespace talus
