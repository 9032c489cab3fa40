#include "framework/kinematics/plan.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace talus {

// Makes a plan: decides which nodes are needed, what each depends on, and where its lanes are kept.
class Plan::Builder {
 public:
  Builder(const Program& program, Plan& plan) : program_(program), tape_(*program.tape), plan_(plan) {
    target_of_.resize(program.slots);
    for (std::size_t set = 0; set < plan.sets_.size(); ++set) {
      for (std::size_t i = 0; i < plan.sets_[set].size(); ++i)
        target_of_[plan.sets_[set][i]] = {static_cast<int>(set), static_cast<int>(i)};
      plan.touched_.emplace_back(plan.sets_[set].size(), 0);
    }
    slot_class_.assign(program.slots, kData);
    for (const Parameter& p : program.parameters) slot_class_[p.slot] = kUniform;
    for (int slot : plan.state_) slot_class_[slot] = kState;
    for (const Chain& c : program.chains)
      for (int i = 0; i < 12; ++i) slot_class_[c.first_slot + i] = kChain;
  }

  void build() {
    for (const Row& row : program_.rows) want(row.value);
    for (std::size_t c = 0; c < program_.chains.size(); ++c) wrenches(static_cast<int>(c));
    for (std::size_t c = 0; c < program_.chains.size(); ++c)
      if (used_[c]) steps(static_cast<int>(c));
    place();
  }

 private:
  enum Class : unsigned char { kConstant = 0, kUniform = 1, kData = 2, kState = 4, kChain = 8 };

  unsigned char classify(std::int32_t i) {
    if (i < 0) return kConstant;
    if (static_cast<std::size_t>(i) >= class_.size()) class_.resize(tape_.size(), 0xFF);
    if (class_[i] != 0xFF) return class_[i];
    const Node& n = tape_[i];
    unsigned char result = n.op == Op::constant ? 0u + kConstant
                           : n.op == Op::leaf   ? slot_class_[n.a]
                                                : static_cast<unsigned char>(classify(n.a) | classify(n.b) | classify(n.c));
    return class_[i] = result;
  }

  // Remembers that the expression's lanes are needed; returns its node.
  std::int32_t want(const Expr& e) {
    const std::int32_t node = e.node_on(tape_);
    wanted_.insert(node);
    return node;
  }

  // The wrench of each row at the end of chain c, as expressions: f = dr/dp, and the moment about the base
  // n = p x f + sum over columns R_j x dr/dR_j.
  void wrenches(int c) {
    const Chain& chain = program_.chains[c];
    ChainPlan& out = plan_.chains_.emplace_back();
    Matrix3<Expr> R;
    Vector3<Expr> p;
    auto entry = [&](int i) { return Expr::leaf(tape_, chain.first_slot + i); };
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) R[i][j] = entry(3 * i + j);
      p[i] = entry(9 + i);
    }
    bool used = false;
    for (std::size_t r = 0; r < program_.rows.size(); ++r) {
      const auto g = gradient(program_.rows[r].value);
      auto part = [&](int i) {
        auto it = g.find(chain.first_slot + i);
        return it == g.end() ? Expr() : it->second;
      };
      const Vector3<Expr> f{part(9), part(10), part(11)};
      Vector3<Expr> n = cross<Expr>(p, f);
      for (int j = 0; j < 3; ++j) {
        const Vector3<Expr> t = cross<Expr>({R[0][j], R[1][j], R[2][j]}, {part(j), part(3 + j), part(6 + j)});
        for (int i = 0; i < 3; ++i) n[i] += t[i];
      }
      auto zero = [](const Vector3<Expr>& v) {
        return std::all_of(v.begin(), v.end(), [](const Expr& e) { return e.is_constant() && e.constant() == 0; });
      };
      const bool has_force = !zero(f), row_used = has_force || !zero(n);
      out.row_used.push_back(row_used);
      out.row_has_force.push_back(has_force);
      used |= row_used;
      std::array<std::int32_t, 6> nodes;
      nodes.fill(-1);
      if (row_used)
        for (int i = 0; i < 3; ++i) {
          if (has_force) nodes[i] = want(f[i]);
          nodes[3 + i] = want(n[i]);
        }
      out.wrench_nodes.push_back(nodes);
      if (c == 0)
        for (const auto& [slot, d] : sorted(g))
          if (target_of_[slot].set >= 0)
            plan_.direct_.push_back({static_cast<int>(r), target_of_[slot], want(d), false});
    }
    used_.push_back(used);
  }

  bool first(Target to) { return !std::exchange(plan_.touched_[to.set][to.column], 1); }

  void steps(int c) {
    ChainPlan& chain = plan_.chains_[c];
    chain.contributions.resize(plan_.sets_.size());
    for (const Motion<Expr>& m : program_.chains[c].motions.motions()) {
      const int index = static_cast<int>(chain.steps.size());
      Step& step = chain.steps.emplace_back(Step{m.kind, m.axis});
      if (m.kind == Motion<Expr>::Kind::matrix) {
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) step.matrix[3 * i + j] = want(m.rotation[i][j]);
          step.matrix[9 + i] = want(m.translation[i]);
        }
        twists(c, index, m);
        continue;
      }
      const bool rotation = m.kind == Motion<Expr>::Kind::rotation;
      step.a = want(rotation ? sin(m.amount) : m.amount);
      if (rotation) step.b = want(cos(m.amount));
      for (const auto& [slot, d] : sorted(gradient(m.amount))) {
        const Target to = target_of_[slot];
        if (to.set < 0) continue;
        const bool one = d.is_constant() && d.constant() == 1, minus = d.is_constant() && d.constant() == -1;
        step.line = 0;  // placed later
        contribute(chain, to, one ? -1 : minus ? -2 : want(d), !rotation, index, -1);
      }
    }
  }

  // Until the axes are placed, `line` says whose it is.
  void contribute(ChainPlan& chain, Target to, std::int32_t factor, bool translation, int step, int twist) {
    const auto owner = static_cast<std::int32_t>(owners_.size());
    owners_.push_back({step, twist});
    chain.contributions[to.set].push_back({to, factor, first(to), owner, translation, false});
  }

  static std::map<int, Expr> sorted(const std::unordered_map<std::int32_t, Expr>& g) { return {g.begin(), g.end()}; }

  // Per slot s: [w] = R^T dR/ds, v = R^T dt/ds, in the frame behind the motion.
  void twists(int c, int index, const Motion<Expr>& m) {
    std::map<int, std::array<Expr, 12>> d;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        for (const auto& [slot, e] : gradient(m.rotation[i][j])) d[slot][3 * i + j] = e;
      for (const auto& [slot, e] : gradient(m.translation[i])) d[slot][9 + i] = e;
    }
    ChainPlan& chain = plan_.chains_[c];
    for (const auto& entry : d) {
      const std::array<Expr, 12>& e = entry.second;
      const Target to = target_of_[entry.first];
      if (to.set < 0) continue;
      auto product = [&](int i, int j) {  // (R^T dR)_ij
        Expr sum;
        for (int k = 0; k < 3; ++k) sum += m.rotation[k][i] * e[3 * k + j];
        return sum;
      };
      auto moved = [&](int i) {
        Expr sum;
        for (int k = 0; k < 3; ++k) sum += m.rotation[k][i] * e[9 + k];
        return sum;
      };
      std::vector<Step::Twist>& list = chain.steps[index].twists;
      list.push_back({{want(product(2, 1)), want(product(0, 2)), want(product(1, 0)), want(moved(0)), want(moved(1)), want(moved(2))}, 0});
      contribute(chain, to, -1, false, index, static_cast<int>(list.size()) - 1);
    }
  }

  // Gives every needed node its lanes and writes the instructions.
  void place() {
    std::set<std::int32_t> needed, uniform, data;
    std::vector<std::int32_t> stack(wanted_.begin(), wanted_.end());
    while (!stack.empty()) {
      const std::int32_t i = stack.back();
      stack.pop_back();
      if (i < 0) continue;
      const unsigned char k = classify(i);
      auto& set = k <= kUniform ? uniform : k == kData ? data : needed;
      if (!set.insert(i).second || k == kData) continue;
      const Node& n = tape_[i];
      if (n.op != Op::leaf && n.op != Op::constant) stack.insert(stack.end(), {n.a, n.b, n.c});
    }
    std::map<std::int32_t, std::int32_t> where;  // node -> offset
    std::int32_t next = 0;
    auto take = [&](int count) {
      const std::int32_t offset = next;
      next += count * lanes;
      return offset;
    };
    plan_.data_nodes_.assign(data.begin(), data.end());
    plan_.data_offset_ = take(static_cast<int>(data.size()));
    for (std::size_t i = 0; i < plan_.data_nodes_.size(); ++i)
      where[plan_.data_nodes_[i]] = plan_.data_offset_ + static_cast<int>(i) * lanes;
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
    // Uniform nodes: scalars, and lanes for those that are used beside lane nodes.
    std::map<std::int32_t, std::int32_t> scalar;
    for (std::int32_t i : uniform) {
      const Node& n = tape_[i];
      const auto out = static_cast<std::int32_t>(scalar.size());
      auto arg = [&](std::int32_t a) { return a >= 0 ? scalar[a] : -1; };
      scalar[i] = out;
      if (n.op == Op::leaf) plan_.uniform_.push_back({n.op, out, n.a, -1, -1, 0});
      else plan_.uniform_.push_back({n.op, out, arg(n.a), arg(n.b), arg(n.c), n.value});
    }
    std::vector<std::int32_t> spare;  // lanes of nodes that nobody needs any more
    auto offset = [&](std::int32_t i) {
      if (i < 0) return std::int32_t(0);
      auto [it, fresh] = where.try_emplace(i, 0);
      if (fresh) {
        const bool reuse = !spare.empty() && !uniform.contains(i);
        it->second = reuse ? spare.back() : take(1);
        if (reuse) spare.pop_back();
        if (uniform.contains(i)) plan_.broadcast_.emplace_back(scalar[i], it->second);
      }
      return it->second;
    };
    // Products and sums that are used once, and sines beside cosines, become one instruction.
    std::map<std::int32_t, int> uses;
    for (std::int32_t i : needed)
      if (const Node& n = tape_[i]; n.op != Op::leaf)
        for (std::int32_t a : {n.a, n.b, n.c})
          if (a >= 0) ++uses[a];
    auto product = [&](std::int32_t i) {
      return tape_[i].op == Op::mul && needed.contains(i) && !wanted_.contains(i) && uses[i] == 1;
    };
    std::set<std::int32_t> inside;  // done within another instruction
    struct Fusion {
      Instruction::Fused kind;
      std::int32_t a, b, c;
    };
    std::map<std::int32_t, Fusion> fusions;
    using Fused = Instruction::Fused;
    for (std::int32_t i : needed) {
      const Node& n = tape_[i];
      if (n.op == Op::add || n.op == Op::sub) {
        if (product(n.b)) {
          const Node& m = tape_[n.b];
          fusions[i] = {n.op == Op::add ? Fused::multiply_add : Fused::subtract_product, m.a, m.b, n.a};
          inside.insert(n.b);
        } else if (product(n.a)) {
          const Node& m = tape_[n.a];
          fusions[i] = {n.op == Op::add ? Fused::multiply_add : Fused::multiply_subtract, m.a, m.b, n.b};
          inside.insert(n.a);
        }
      }
    }
    std::map<std::int32_t, std::int32_t> cosine_of;  // argument -> cosine node
    for (std::int32_t i : needed)
      if (tape_[i].op == Op::cos) cosine_of[tape_[i].a] = i;
    for (std::int32_t i : needed)
      if (const Node& n = tape_[i]; n.op == Op::sin && cosine_of.contains(n.a)) {
        fusions[i] = {Fused::sine_and_cosine, n.a, -1, cosine_of[n.a]};
        inside.insert(cosine_of[n.a]);
      }
    for (auto& [i, f] : fusions)
      if (f.kind == Fused::sine_and_cosine && f.c < i) inside.erase(f.c), f.kind = Fused::none;  // needed earlier
    struct Pending {
      Instruction::Fused fused;
      std::int32_t node, a, b, c;
    };
    std::array<std::vector<Pending>, 2> pending;  // before and after the chains
    for (std::int32_t i : needed) {
      const Node& n = tape_[i];
      if (n.op == Op::leaf) {
        if (slot_class_[n.a] == kState) {
          const auto s = std::find(plan_.state_.begin(), plan_.state_.end(), n.a) - plan_.state_.begin();
          where[i] = plan_.state_offset_ + static_cast<int>(s) * lanes;
        } else {
          for (std::size_t c = 0; c < program_.chains.size(); ++c)
            if (int k = n.a - program_.chains[c].first_slot; k >= 0 && k < 12) where[i] = plan_.chains_[c].pose + k * lanes;
        }
      } else if (!inside.contains(i)) {
        const auto f = fusions.find(i);
        const bool fused = f != fusions.end() && f->second.kind != Fused::none;
        pending[classify(i) & kChain ? 1 : 0].push_back(
            fused ? Pending{f->second.kind, i, f->second.a, f->second.b, f->second.c} : Pending{Fused::none, i, n.a, n.b, n.c});
      }
    }
    // Independent instructions of one kind stand together: the interpreter then runs them without branching.
    std::map<std::int32_t, int> depth;
    for (auto& list : pending) {
      for (const Pending& k : list) {
        int d = 0;
        for (std::int32_t a : {k.a, k.b, k.c})
          if (a >= 0 && a != k.node && !(k.fused == Fused::sine_and_cosine && a == k.c)) d = std::max(d, depth[a] + 1);
        depth[k.node] = d;
        if (k.fused == Fused::sine_and_cosine) depth[k.c] = d;
      }
      std::stable_sort(list.begin(), list.end(), [&](const Pending& x, const Pending& y) {
        return std::tuple(depth[x.node], x.fused, tape_[x.node].op) < std::tuple(depth[y.node], y.fused, tape_[y.node].op);
      });
    }
    std::map<std::int32_t, const Pending*> last_use;
    for (const auto& list : pending)
      for (const Pending& k : list)
        for (std::int32_t a : {k.a, k.b, k.c}) last_use[a] = &k;
    for (int stage = 0; stage < 2; ++stage)
      for (const Pending& k : pending[stage]) {
        const std::int32_t a = offset(k.a), b = offset(k.b), c = offset(k.c);
        (stage ? plan_.after_ : plan_.before_).push_back({tape_[k.node].op, k.fused, offset(k.node), a, b, c});
        std::set<std::int32_t> done;
        for (std::int32_t i : {k.a, k.b, k.c})
          if (i >= 0 && last_use[i] == &k && needed.contains(i) && tape_[i].op != Op::leaf && !wanted_.contains(i) && done.insert(i).second)
            spare.push_back(where[i]);
      }
    auto fix = [&](std::int32_t& node) { node = offset(node); };
    for (const Row& row : program_.rows) plan_.row_nodes_.push_back(offset(row.value.node_on(tape_)));
    for (std::size_t c = 0; c < plan_.chains_.size(); ++c) {
      for (auto& nodes : plan_.chains_[c].wrench_nodes)
        for (auto& node : nodes)
          if (node >= 0) fix(node);
      for (Step& s : plan_.chains_[c].steps) {
        if (s.kind == Motion<Expr>::Kind::matrix) {
          for (auto& node : s.matrix) fix(node);
        } else {
          fix(s.a);
          if (s.kind == Motion<Expr>::Kind::rotation) fix(s.b);
        }
        for (Step::Twist& t : s.twists)
          for (auto& node : t.parts) fix(node);
      }
      for (auto& list : plan_.chains_[c].contributions)
        for (Contribution& k : list)
          if (k.factor >= 0) fix(k.factor);
    }
    for (Direct& d : plan_.direct_) {
      fix(d.node);
      d.first = first(d.to);
    }
    plan_.scalar_offset_ = next;
    plan_.workspace_size_ = static_cast<std::size_t>(next) + scalar.size();
    std::set<int> slots;
    for (std::int32_t node : plan_.data_nodes_)
      for (int slot : support(Expr(&tape_, node))) slots.insert(slot);
    plan_.data_slots_.assign(slots.begin(), slots.end());
    plan_.data_values_ = TapeValues(tape_, plan_.data_nodes_);
    plan_.row_slots_ = row_support(program_);
  }

  const Program& program_;
  Tape& tape_;
  Plan& plan_;
  std::vector<Target> target_of_;
  std::vector<unsigned char> slot_class_, class_;
  std::set<std::int32_t> wanted_;
  std::vector<std::pair<int, int>> owners_;  // of axes: step, twist
  std::vector<char> used_;
};

Plan::Plan(const Program& program, std::vector<std::vector<int>> sets, std::vector<int> state)
    : sets_(std::move(sets)), state_(std::move(state)) {
  Builder(program, *this).build();
}

}  // namespace talus
