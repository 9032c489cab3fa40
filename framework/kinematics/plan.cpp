#include "framework/kinematics/plan.h"

#include <algorithm>

#include "framework/kinematics/plan_builder.h"

namespace talus {

Plan::Builder::Builder(const Program& program, Plan& plan)
    : program_(program), tape_(*program.tape), plan_(plan) {
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

void Plan::Builder::build() {
  for (const Row& row : program_.rows) want(row.value);
  for (std::size_t c = 0; c < program_.chains.size(); ++c) wrenches(static_cast<int>(c));
  for (std::size_t c = 0; c < program_.chains.size(); ++c)
    if (used_[c]) steps(static_cast<int>(c));
  sort_by_class();
  place_data_and_chains();
  place_uniform();
  schedule();
  resolve();
}

// Remembers that the expression's lanes are needed; returns its node.
std::int32_t Plan::Builder::want(const Expr& e) {
  const std::int32_t node = e.node_on(tape_);
  wanted_.insert(node);
  return node;
}

// The wrench of each row at the end of chain c, as expressions: f = dr/dp, and the moment about the
// base n = p x f + sum over columns R_j x dr/dR_j.
void Plan::Builder::wrenches(int c) {
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
      const Vector3<Expr> t =
          cross<Expr>({R[0][j], R[1][j], R[2][j]}, {part(j), part(3 + j), part(6 + j)});
      for (int i = 0; i < 3; ++i) n[i] += t[i];
    }
    auto zero = [](const Vector3<Expr>& v) {
      return std::all_of(v.begin(), v.end(),
                         [](const Expr& e) { return e.is_constant() && e.constant() == 0; });
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

void Plan::Builder::steps(int c) {
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
      const bool one = d.is_constant() && d.constant() == 1,
                 minus = d.is_constant() && d.constant() == -1;
      step.line = 0;  // placed later
      contribute(chain, to, one ? -1 : minus ? -2 : want(d), !rotation, index, -1);
    }
  }
}

// Until the axes are placed, `line` says whose it is.
void Plan::Builder::contribute(ChainPlan& chain, Target to, std::int32_t factor, bool translation,
                               int step, int twist) {
  const auto owner = static_cast<std::int32_t>(owners_.size());
  owners_.push_back({step, twist});
  chain.contributions[to.set].push_back({to, factor, first(to), owner, translation, false});
}

// Per slot s: [w] = R^T dR/ds, v = R^T dt/ds, in the frame behind the motion.
void Plan::Builder::twists(int c, int index, const Motion<Expr>& m) {
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
    list.push_back({{want(product(2, 1)), want(product(0, 2)), want(product(1, 0)), want(moved(0)),
                     want(moved(1)), want(moved(2))},
                    0});
    contribute(chain, to, -1, false, index, static_cast<int>(list.size()) - 1);
  }
}

Plan::Plan(const Program& program, std::vector<std::vector<int>> sets, std::vector<int> state)
    : sets_(std::move(sets)), state_(std::move(state)) {
  Builder(program, *this).build();
}

}  // namespace talus
