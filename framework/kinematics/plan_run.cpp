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
  using Fused = Instruction::Fused;
  const Instruction* in = instructions.data();
  const Instruction* const end = in + instructions.size();
  // All neighbours of one kind, one after the other.
  auto alike = [&](auto f) {
    const Op op = in->op;
    const Fused fused = in->fused;
    do {
      double* out = w + in->out;
      const double *a = w + in->a, *b = w + in->b, *c = w + in->c;
      for (int i = 0; i < lanes; i += step) store(out + i, f(a + i, b + i, c + i));
    } while (++in != end && in->op == op && in->fused == fused);
  };
  using P = const double*;
  while (in != end) {
    switch (in->fused) {
      case Fused::none:
        break;
      case Fused::multiply_add:
        alike([](P a, P b, P c) { return xsimd::fma(load(a), load(b), load(c)); });
        continue;
      case Fused::multiply_subtract:
        alike([](P a, P b, P c) { return xsimd::fms(load(a), load(b), load(c)); });
        continue;
      case Fused::subtract_product:
        alike([](P a, P b, P c) { return xsimd::fnma(load(a), load(b), load(c)); });
        continue;
      case Fused::sine_and_cosine:
        alike([](P a, P, P c) {
          const auto both = xsimd::sincos(load(a));
          store(const_cast<double*>(c), both.second);
          return both.first;
        });
        continue;
    }
    switch (in->op) {
      case Op::add:
        alike([](P a, P b, P) { return load(a) + load(b); });
        break;
      case Op::sub:
        alike([](P a, P b, P) { return load(a) - load(b); });
        break;
      case Op::mul:
        alike([](P a, P b, P) { return load(a) * load(b); });
        break;
      case Op::div:
        alike([](P a, P b, P) { return load(a) / load(b); });
        break;
      case Op::neg:
        alike([](P a, P, P) { return -load(a); });
        break;
      case Op::sin:
        alike([](P a, P, P) { return xsimd::sin(load(a)); });
        break;
      case Op::cos:
        alike([](P a, P, P) { return xsimd::cos(load(a)); });
        break;
      case Op::atan2:
        alike([](P a, P b, P) { return xsimd::atan2(load(a), load(b)); });
        break;
      case Op::sqrt:
        alike([](P a, P, P) { return xsimd::sqrt(load(a)); });
        break;
      case Op::acos:
        alike([](P a, P, P) { return xsimd::acos(load(a)); });
        break;
      case Op::asin:
        alike([](P a, P, P) { return xsimd::asin(load(a)); });
        break;
      case Op::abs:
        alike([](P a, P, P) { return xsimd::abs(load(a)); });
        break;
      case Op::less:
        alike([](P a, P b, P) { return xsimd::select(load(a) < load(b), V(1.0), V(0.0)); });
        break;
      case Op::select:
        alike([](P a, P b, P c) { return xsimd::select(load(a) != V(0.0), load(b), load(c)); });
        break;
      default: {
        double* out = w + in->out;
        for (int i = 0; i < lanes; ++i)
          out[i] = apply(in->op, w[in->a + i], w[in->b + i], w[in->c + i]);
        ++in;
      }
    }
  }
}

void Plan::set_parameters(Buffer& workspace, std::span<const double> slots) const {
  double* s = workspace.data() + scalar_offset_;
  auto at = [&](std::int32_t i) { return i >= 0 ? s[i] : 0.0; };
  for (const UniformNode& u : uniform_)
    s[u.out] = u.op == Op::leaf       ? slots[u.a]
               : u.op == Op::constant ? u.value
                                      : apply(u.op, at(u.a), at(u.b), at(u.c));
  for (const auto& [from, to] : broadcast_)
    each(&workspace[to], [value = s[from]](int) { return V(value); });
}

namespace {

struct RunningPose {
  V R[3][3], p[3];

  template <int Axis>
  void rotate(const V& sine, const V& cosine) {
    constexpr int u = (Axis + 1) % 3, v = (Axis + 2) % 3;
    for (auto& row : R) {
      const V ru = row[u], rv = row[v];
      row[u] = xsimd::fma(ru, cosine, rv * sine);
      row[v] = xsimd::fms(rv, cosine, ru * sine);
    }
  }
  template <int Axis>
  void translate(const V& by) {
    for (int i = 0; i < 3; ++i) p[i] = xsimd::fma(R[i][Axis], by, p[i]);
  }
  // Direction w and moment about the base v + p x w.
  void keep(double* line, const V (&w)[3], const V (&v)[3]) const {
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      store(line + i * lanes, w[i]);
      store(line + (3 + i) * lanes, xsimd::fma(p[j], w[k], xsimd::fnma(p[k], w[j], v[i])));
    }
  }
  template <int Axis, bool Rotation>
  void elementary(const double* a, const double* b, double* line) {
    if constexpr (Rotation)
      rotate<Axis>(load(a), load(b));
    else
      translate<Axis>(load(a));
    if (!line) return;
    const V w[3] = {R[0][Axis], R[1][Axis], R[2][Axis]};
    if constexpr (Rotation)
      keep(line, w, {V(0.0), V(0.0), V(0.0)});
    else
      for (int i = 0; i < 3; ++i) store(line + i * lanes, w[i]);
  }
};

}  // namespace

void Plan::forward(const ChainPlan& chain, double* w) {
  if (chain.pose < 0) return;
  for (int l = 0; l < lanes; l += step) {
    RunningPose T;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) T.R[i][j] = V(i == j ? 1.0 : 0.0);
      T.p[i] = V(0.0);
    }
    for (const Step& s : chain.steps) {
      const double *a = w + s.a + l, *b = w + s.b + l;
      double* line = s.line >= 0 ? w + s.line + l : nullptr;
      if (s.kind == Motion<Expr>::Kind::rotation) {
        if (s.axis == 0)
          T.elementary<0, true>(a, b, line);
        else if (s.axis == 1)
          T.elementary<1, true>(a, b, line);
        else
          T.elementary<2, true>(a, b, line);
        continue;
      }
      if (s.kind == Motion<Expr>::Kind::translation) {
        if (s.axis == 0)
          T.elementary<0, false>(a, b, line);
        else if (s.axis == 1)
          T.elementary<1, false>(a, b, line);
        else
          T.elementary<2, false>(a, b, line);
        continue;
      }
      auto m = [&](int k) { return load(w + s.matrix[k] + l); };
      for (int i = 0; i < 3; ++i) {
        const V x = T.R[i][0], y = T.R[i][1], z = T.R[i][2];
        for (int j = 0; j < 3; ++j)
          T.R[i][j] = xsimd::fma(x, m(j), xsimd::fma(y, m(3 + j), z * m(6 + j)));
        T.p[i] += xsimd::fma(x, m(9), xsimd::fma(y, m(10), z * m(11)));
      }
      for (const Step::Twist& t : s.twists) {
        V turned[2][3];
        for (int h = 0; h < 2; ++h)
          for (int i = 0; i < 3; ++i) {
            auto part = [&](int k) { return load(w + t.parts[3 * h + k] + l); };
            turned[h][i] =
                xsimd::fma(T.R[i][0], part(0), xsimd::fma(T.R[i][1], part(1), T.R[i][2] * part(2)));
          }
        T.keep(w + t.line + l, turned[0], turned[1]);
      }
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) store(w + chain.pose + (3 * i + j) * lanes + l, T.R[i][j]);
      store(w + chain.pose + (9 + i) * lanes + l, T.p[i]);
    }
  }
}

void Plan::evaluate(Buffer& workspace, const double* data, const double* state) const {
  double* w = workspace.data();
  std::memcpy(w + data_offset_, data, data_nodes_.size() * lanes * sizeof(double));
  if (!state_.empty())
    std::memcpy(w + state_offset_, state, state_.size() * lanes * sizeof(double));
  run(before_, w);
  for (const ChainPlan& chain : chains_) forward(chain, w);
  run(after_, w);
}

const double* Plan::pose(const Buffer& workspace, int chain) const {
  return &workspace[chains_[chain].pose];
}

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
              sum = xsimd::fma(load(transform.values + (r * m + q) * lanes + l),
                               load(w + chain.wrench_nodes[q][k] + l), sum);
          return sum;
        });
      } else if (node >= 0 && transform.kind == RowTransform::Kind::diagonal) {
        each(out,
             [&](int l) { return load(w + node + l) * load(transform.values + r * lanes + l); });
      } else if (node >= 0) {
        each(out, [&](int l) { return load(w + node + l); });
      }
    }
}

// A few rows at a time, so that their wrenches stay in registers while the columns pass by.
template <int Rows, bool Force>
void Plan::fill_columns(const std::vector<Contribution>& list, const double* const* wrench,
                        double* const* out, std::size_t stride, const double* w) {
  for (int l = 0; l < lanes; l += step) {
    V f[Rows][3], n[Rows][3], g[Rows];
    for (int r = 0; r < Rows; ++r)
      for (int i = 0; i < 3; ++i) {
        if constexpr (Force) f[r][i] = load(wrench[r] + i * lanes + l);
        n[r][i] = load(wrench[r] + (3 + i) * lanes + l);
      }
    for (const Contribution& k : list) {
      if (!k.again) {
        const double* line = w + k.line + l;
        const V x = load(line), y = load(line + lanes), z = load(line + 2 * lanes);
        if (k.translation) {  // direction . force
          for (int r = 0; r < Rows; ++r) {
            if constexpr (Force)
              g[r] = xsimd::fma(x, f[r][0], xsimd::fma(y, f[r][1], z * f[r][2]));
            else
              g[r] = V(0.0);
          }
        } else {  // direction . moment + moment of the axis . force
          for (int r = 0; r < Rows; ++r)
            g[r] = xsimd::fma(x, n[r][0], xsimd::fma(y, n[r][1], z * n[r][2]));
          if constexpr (Force) {
            const V a = load(line + 3 * lanes), b = load(line + 4 * lanes),
                    c = load(line + 5 * lanes);
            for (int r = 0; r < Rows; ++r)
              g[r] = xsimd::fma(a, f[r][0], xsimd::fma(b, f[r][1], xsimd::fma(c, f[r][2], g[r])));
          }
        }
      }
      const std::size_t at = k.to.column * stride + l;
      if (k.first && k.factor == -1) {
        for (int r = 0; r < Rows; ++r) store(out[r] + at, g[r]);
        continue;
      }
      const V factor = k.factor >= 0 ? load(w + k.factor + l) : V(k.factor == -2 ? -1.0 : 1.0);
      for (int r = 0; r < Rows; ++r)
        store(out[r] + at, k.first ? g[r] * factor : xsimd::fma(g[r], factor, load(out[r] + at)));
    }
  }
}

void Plan::jacobian(Buffer& workspace, int set, const RowTransform& transform, double* J,
                    std::size_t stride) const {
  double* w = workspace.data();
  const int m = rows();
  const std::size_t size = static_cast<std::size_t>(m) * lanes;
  const bool dense = transform.kind == RowTransform::Kind::dense;
  for (std::size_t c = 0; c < sets_[set].size(); ++c)
    if (!touched_[set][c]) std::memset(J + c * stride, 0, size * sizeof(double));
  for (const ChainPlan& chain : chains_) {
    if (chain.pose < 0 || chain.contributions[set].empty()) continue;
    wrenches(chain, transform, w);
    const double* wrench[3];
    double* out[3];
    for (bool force : {false, true}) {
      int filled = 0;
      auto flush = [&] {
        const auto& list = chain.contributions[set];
        if (filled == 3)
          (force ? fill_columns<3, true> : fill_columns<3, false>)(list, wrench, out, stride, w);
        if (filled == 2)
          (force ? fill_columns<2, true> : fill_columns<2, false>)(list, wrench, out, stride, w);
        if (filled == 1)
          (force ? fill_columns<1, true> : fill_columns<1, false>)(list, wrench, out, stride, w);
        filled = 0;
      };
      for (int r = 0; r < m; ++r) {
        if (!dense && !chain.row_used[r]) continue;
        if ((dense || chain.row_has_force[r]) != force) continue;
        wrench[filled] = w + chain.wrench + r * 6 * lanes;
        out[filled++] = J + r * lanes;
        if (filled == 3) flush();
      }
      flush();
    }
    if (!dense)
      for (const Contribution& k : chain.contributions[set])
        for (int r = 0; k.first && r < m; ++r)
          if (!chain.row_used[r])
            std::memset(J + k.to.column * stride + r * lanes, 0, lanes * sizeof(double));
  }
  for (const Direct& d : direct_) {
    if (d.to.set != set) continue;
    double* out = J + d.to.column * stride;
    if (d.first) std::memset(out, 0, size * sizeof(double));
    for (int r = 0; r < m; ++r) {
      if (!dense && r != d.row) continue;
      const double* factor = dense ? transform.values + (r * m + d.row) * lanes
                             : transform.kind == RowTransform::Kind::diagonal
                                 ? transform.values + r * lanes
                                 : nullptr;
      each(out + r * lanes, [&](int l) {
        const V value = factor ? load(w + d.node + l) * load(factor + l) : load(w + d.node + l);
        return value + load(out + r * lanes + l);
      });
    }
  }
}

}  // namespace talus
