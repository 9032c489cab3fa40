// The inner loops of a plan. All arrays are [something][lane] and aligned to 64 bytes.
#include <cstring>
#include <xsimd/xsimd.hpp>

#include "framework/kinematics/plan.h"

namespace talus {
namespace {

using V = xsimd::batch<double>;
constexpr int step = static_cast<int>(V::size);
static_assert(lanes % step == 0);

inline V load(const double* p) { return V::load_aligned(p); }
inline void store(double* p, const V& v) { v.store_aligned(p); }

template <class F>
inline void each(double* out, F f) {
  for (int i = 0; i < lanes; i += step) store(out + i, f(i));
}

}  // namespace

void Plan::run(const std::vector<Instruction>& instructions, double* w) {
  for (const Instruction& in : instructions) {
    double* out = w + in.out;
    const double *a = w + in.a, *b = w + in.b, *c = w + in.c;
    switch (in.op) {
      case Op::add: each(out, [&](int i) { return load(a + i) + load(b + i); }); break;
      case Op::sub: each(out, [&](int i) { return load(a + i) - load(b + i); }); break;
      case Op::mul: each(out, [&](int i) { return load(a + i) * load(b + i); }); break;
      case Op::div: each(out, [&](int i) { return load(a + i) / load(b + i); }); break;
      case Op::neg: each(out, [&](int i) { return -load(a + i); }); break;
      case Op::sin: each(out, [&](int i) { return xsimd::sin(load(a + i)); }); break;
      case Op::cos: each(out, [&](int i) { return xsimd::cos(load(a + i)); }); break;
      case Op::atan2: each(out, [&](int i) { return xsimd::atan2(load(a + i), load(b + i)); }); break;
      case Op::sqrt: each(out, [&](int i) { return xsimd::sqrt(load(a + i)); }); break;
      case Op::acos: each(out, [&](int i) { return xsimd::acos(load(a + i)); }); break;
      case Op::asin: each(out, [&](int i) { return xsimd::asin(load(a + i)); }); break;
      case Op::abs: each(out, [&](int i) { return xsimd::abs(load(a + i)); }); break;
      case Op::less:
        each(out, [&](int i) { return xsimd::select(load(a + i) < load(b + i), V(1.0), V(0.0)); });
        break;
      case Op::select:
        each(out, [&](int i) { return xsimd::select(load(a + i) != V(0.0), load(b + i), load(c + i)); });
        break;
      default:
        for (int i = 0; i < lanes; ++i) out[i] = apply(in.op, a[i], b[i], c[i]);
    }
  }
}

void Plan::set_parameters(Buffer& workspace, std::span<const double> slots) const {
  double* s = workspace.data() + scalar_offset_;
  auto at = [&](std::int32_t i) { return i >= 0 ? s[i] : 0.0; };
  for (const UniformNode& u : uniform_)
    s[u.out] = u.op == Op::leaf ? slots[u.a] : u.op == Op::constant ? u.value : apply(u.op, at(u.a), at(u.b), at(u.c));
  for (const auto& [from, to] : broadcast_) each(&workspace[to], [value = s[from]](int) { return V(value); });
}

void Plan::forward(const ChainPlan& chain, double* w) {
  if (chain.pose < 0) return;
  double* T = w + chain.pose;  // R row by row, then p
  for (int i = 0; i < 12; ++i) each(T + i * lanes, [&](int) { return V(i == 0 || i == 4 || i == 8 ? 1.0 : 0.0); });
  auto R = [&](int i, int j) { return T + (3 * i + j) * lanes; };
  auto p = [&](int i) { return T + (9 + i) * lanes; };
  for (const Step& s : chain.steps) {
    for (int l = 0; l < lanes; l += step) {
      if (s.kind == Motion<Expr>::Kind::translation) {
        const V by = load(w + s.a + l);
        for (int i = 0; i < 3; ++i) store(p(i) + l, xsimd::fma(load(R(i, s.axis) + l), by, load(p(i) + l)));
      } else if (s.kind == Motion<Expr>::Kind::rotation) {
        const int u = (s.axis + 1) % 3, v = (s.axis + 2) % 3;
        const V sine = load(w + s.a + l), cosine = load(w + s.b + l);
        for (int i = 0; i < 3; ++i) {
          const V ru = load(R(i, u) + l), rv = load(R(i, v) + l);
          store(R(i, u) + l, xsimd::fma(ru, cosine, rv * sine));
          store(R(i, v) + l, xsimd::fms(rv, cosine, ru * sine));
        }
      } else {
        auto m = [&](int k) { return load(w + s.matrix[k] + l); };
        for (int i = 0; i < 3; ++i) {
          const V a = load(R(i, 0) + l), b = load(R(i, 1) + l), c = load(R(i, 2) + l);
          for (int j = 0; j < 3; ++j) store(R(i, j) + l, xsimd::fma(a, m(j), xsimd::fma(b, m(3 + j), c * m(6 + j))));
          store(p(i) + l, load(p(i) + l) + xsimd::fma(a, m(9), xsimd::fma(b, m(10), c * m(11))));
        }
      }
      auto axis = [&](double* line, const V& wx, const V& wy, const V& wz, const V& vx, const V& vy, const V& vz) {
        // Moment about the base: v + p x w.
        const V px = load(p(0) + l), py = load(p(1) + l), pz = load(p(2) + l);
        store(line + l, wx), store(line + lanes + l, wy), store(line + 2 * lanes + l, wz);
        store(line + 3 * lanes + l, vx + py * wz - pz * wy);
        store(line + 4 * lanes + l, vy + pz * wx - px * wz);
        store(line + 5 * lanes + l, vz + px * wy - py * wx);
      };
      if (s.line >= 0) {
        const V x = load(R(0, s.axis) + l), y = load(R(1, s.axis) + l), z = load(R(2, s.axis) + l);
        if (s.kind == Motion<Expr>::Kind::rotation) {
          axis(w + s.line, x, y, z, V(0.0), V(0.0), V(0.0));
        } else {
          store(w + s.line + l, x), store(w + s.line + lanes + l, y), store(w + s.line + 2 * lanes + l, z);
        }
      }
      for (const Twist& t : s.twists) {
        V turned[6];
        for (int h = 0; h < 2; ++h)
          for (int i = 0; i < 3; ++i) {
            turned[3 * h + i] = V(0.0);
            for (int k = 0; k < 3; ++k)
              turned[3 * h + i] = xsimd::fma(load(R(i, k) + l), load(w + t.parts[3 * h + k] + l), turned[3 * h + i]);
          }
        axis(w + t.line, turned[0], turned[1], turned[2], turned[3], turned[4], turned[5]);
      }
    }
  }
}

void Plan::evaluate(Buffer& workspace, const double* data, const double* state) const {
  double* w = workspace.data();
  std::memcpy(w + data_offset_, data, data_nodes_.size() * lanes * sizeof(double));
  if (!state_.empty()) std::memcpy(w + state_offset_, state, state_.size() * lanes * sizeof(double));
  run(before_, w);
  for (const ChainPlan& chain : chains_) forward(chain, w);
  run(after_, w);
}

const double* Plan::pose(const Buffer& workspace, int chain) const { return &workspace[chains_[chain].pose]; }

void Plan::wrenches(const ChainPlan& chain, const RowTransform& transform, double* w) const {
  const int m = rows();
  for (int r = 0; r < m; ++r)
    for (int k = 0; k < 6; ++k) {
      double* out = w + chain.wrench + (r * 6 + k) * lanes;
      const std::int32_t node = chain.wrench_nodes[r][k];
      if (transform.kind == RowTransform::Kind::dense) {
        each(out, [&](int l) {
          V sum(0.0);
          for (int q = 0; q < m; ++q)
            if (chain.wrench_nodes[q][k] >= 0)
              sum = xsimd::fma(load(transform.values + (r * m + q) * lanes + l), load(w + chain.wrench_nodes[q][k] + l), sum);
          return sum;
        });
      } else if (node >= 0 && transform.kind == RowTransform::Kind::diagonal) {
        each(out, [&](int l) { return load(w + node + l) * load(transform.values + r * lanes + l); });
      } else if (node >= 0) {
        each(out, [&](int l) { return load(w + node + l); });
      }
    }
}

void Plan::reciprocal(const ChainPlan& chain, const double* line, bool translation, bool dense, const double* w,
                      double* out) const {
  const int m = rows();
  for (int l = 0; l < lanes; l += step) {
    const V x = load(line + l), y = load(line + lanes + l), z = load(line + 2 * lanes + l);
    if (translation) {  // axis . force
      for (int r = 0; r < m; ++r) {
        const double* f = w + chain.wrench + r * 6 * lanes + l;
        V g(0.0);
        if (dense || chain.row_has_force[r])
          g = xsimd::fma(x, load(f), xsimd::fma(y, load(f + lanes), z * load(f + 2 * lanes)));
        store(out + r * lanes + l, g);
      }
      continue;
    }
    const V a = load(line + 3 * lanes + l), b = load(line + 4 * lanes + l), c = load(line + 5 * lanes + l);
    for (int r = 0; r < m; ++r) {
      const double* f = w + chain.wrench + r * 6 * lanes + l;
      V g(0.0);
      if (dense || chain.row_used[r])
        g = xsimd::fma(x, load(f + 3 * lanes), xsimd::fma(y, load(f + 4 * lanes), z * load(f + 5 * lanes)));
      if (dense || chain.row_has_force[r])
        g = xsimd::fma(a, load(f), xsimd::fma(b, load(f + lanes), xsimd::fma(c, load(f + 2 * lanes), g)));
      store(out + r * lanes + l, g);
    }
  }
}

void Plan::jacobian(Buffer& workspace, int set, const RowTransform& transform, double* J, std::size_t stride) const {
  double* w = workspace.data();
  const int m = rows();
  const std::size_t size = static_cast<std::size_t>(m) * lanes;
  const bool dense = transform.kind == RowTransform::Kind::dense;
  auto add = [&](double* out, bool first, const double* g, const double* factor, double sign) {
    for (int r = 0; r < m; ++r)
      each(out + r * lanes, [&](int l) {
        V value = load(g + r * lanes + l);
        value = factor ? value * load(factor + l) : sign < 0 ? -value : value;
        return first ? value : value + load(out + r * lanes + l);
      });
  };
  for (std::size_t c = 0; c < sets_[set].size(); ++c)
    if (!touched_[set][c]) std::memset(J + c * stride, 0, size * sizeof(double));
  for (const ChainPlan& chain : chains_) {
    if (chain.pose < 0) continue;
    wrenches(chain, transform, w);
    for (const Step& s : chain.steps) {
      const bool translation = s.kind == Motion<Expr>::Kind::translation;
      if (s.contributions.size() == 1 && s.contributions[0].first && s.contributions[0].factor == -1) {
        const Target to = s.contributions[0].to;
        if (to.set == set) reciprocal(chain, w + s.line, translation, dense, w, J + to.column * stride);
        continue;
      }
      bool known = false;
      for (const Contribution& k : s.contributions) {
        if (k.to.set != set) continue;
        if (!known) reciprocal(chain, w + s.line, translation, dense, w, w + scratch_);
        known = true;
        add(J + k.to.column * stride, k.first, w + scratch_, k.factor >= 0 ? w + k.factor : nullptr, k.factor == -2 ? -1 : 1);
      }
      for (const Twist& t : s.twists) {
        if (t.to.set != set) continue;
        reciprocal(chain, w + t.line, false, dense, w, w + scratch_);
        add(J + t.to.column * stride, t.first, w + scratch_, nullptr, 1);
      }
    }
  }
  for (const Direct& d : direct_) {
    if (d.to.set != set) continue;
    double* out = J + d.to.column * stride;
    if (d.first) std::memset(out, 0, size * sizeof(double));
    for (int r = 0; r < m; ++r) {
      if (!dense && r != d.row) continue;
      const double* factor = dense                                             ? transform.values + (r * m + d.row) * lanes
                             : transform.kind == RowTransform::Kind::diagonal ? transform.values + r * lanes
                                                                              : nullptr;
      each(out + r * lanes, [&](int l) {
        const V value = factor ? load(w + d.node + l) * load(factor + l) : load(w + d.node + l);
        return value + load(out + r * lanes + l);
      });
    }
  }
}

}  // namespace talus
