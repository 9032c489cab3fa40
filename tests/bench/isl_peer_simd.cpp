#include "tests/bench/isl_peer_simd.h"

#include <cstdlib>
#include <new>
#include <xsimd/xsimd.hpp>

namespace talus::bench {
namespace {

using Batch = xsimd::batch<double>;
constexpr int width = static_cast<int>(Batch::size);
constexpr int inputs = 18;

// A frame's axes and origin as seen in E; V is double where no pose enters, else Batch.
template <class V>
struct Vector {
  V x, y, z;
};

template <class V>
struct Axes {
  Vector<V> x, y, z, origin;
};

// The frame before a rotation about one of its axes, from the frame after it.
template <class V>
inline void unturn(Vector<V>& first, Vector<V>& second, const V& s, const V& c) {
  const Vector<V> a = first, b = second;
  first = {c * a.x - s * b.x, c * a.y - s * b.y, c * a.z - s * b.z};
  second = {s * a.x + c * b.x, s * a.y + c * b.y, s * a.z + c * b.z};
}

template <class V, class D>
inline void unshift(Vector<V>& origin, const Vector<V>& axis, const D& by) {
  origin = {origin.x - axis.x * by, origin.y - axis.y * by, origin.z - axis.z * by};
}

}  // namespace

// What the parameters alone determine.
struct IslSimd::Fixed {
  IslParameters parameters;
  Axes<double> last;      // axes of frame 6 (before the end mount) in E
  Vector<double> beta_e;  // axis of betaE in E
  double sin_alpha[5], cos_alpha[5];
  double sin_base[2], cos_base[2];  // alphaB, betaB

  explicit Fixed(const IslParameters& p) : parameters(p) {
    const double* end = &p[isl_at::end];
    last = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
    unturn(last.x, last.y, std::sin(end[5]), std::cos(end[5]));
    beta_e = last.x;
    unturn(last.y, last.z, std::sin(end[4]), std::cos(end[4]));
    unturn(last.x, last.y, std::sin(end[3]), std::cos(end[3]));
    unshift(last.origin, last.x, end[0]);
    unshift(last.origin, last.y, end[1]);
    unshift(last.origin, last.z, end[2]);
    for (int i = 0; i < 5; ++i) {
      sin_alpha[i] = std::sin(p[isl_at::alpha + i]);
      cos_alpha[i] = std::cos(p[isl_at::alpha + i]);
    }
    for (int i = 0; i < 2; ++i) {
      sin_base[i] = std::sin(p[isl_at::base + 3 + i]);
      cos_base[i] = std::cos(p[isl_at::base + 3 + i]);
    }
  }
};

namespace {

// Writes the columns of one batch.
class Columns {
 public:
  Columns(double* to, const IslFactors& factors, const Vector<Batch>& e)
      : to_(to), f_(factors), e_(e) {}

  // M of the header, its rows scaled. Each pair: the two entries beside the diagonal.
  Batch xy, xz, yx, yz, zx, zy;

  void shift(int parameter, const Vector<Batch>& u) {
    store(parameter, 0, u.x * -f_[0]);
    store(parameter, 1, u.y * -f_[1]);
    store(parameter, 2, u.z * -f_[2]);
    for (int row = 3; row < 6; ++row) store(parameter, row, Batch(0.));
  }

  struct Column {
    Batch rows[6];
  };

  // A turn about u through the point o.
  Column turn(int parameter, const Vector<Batch>& u, const Vector<Batch>& o) {
    const Vector<Batch> arm = {e_.x - o.x, e_.y - o.y, e_.z - o.z};
    return about(parameter, u, arm);
  }
  Column about(int parameter, const Vector<Batch>& u, const Vector<Batch>& arm) {
    const Column c = {{(arm.y * u.z - arm.z * u.y) * f_[0], (arm.z * u.x - arm.x * u.z) * f_[1],
                       (arm.x * u.y - arm.y * u.x) * f_[2], xy * u.y + xz * u.z - f_[3] * u.x,
                       yx * u.x + yz * u.z - f_[4] * u.y, zx * u.x + zy * u.y - f_[5] * u.z}};
    for (int row = 0; row < 6; ++row) store(parameter, row, c.rows[row]);
    return c;
  }

  void scaled(int parameter, const Column& c, const Batch& by) {
    for (int row = 0; row < 6; ++row) store(parameter, row, c.rows[row] * by);
  }
  void column(int parameter, const Column& c) {
    for (int row = 0; row < 6; ++row) store(parameter, row, c.rows[row]);
  }

 private:
  void store(int parameter, int row, const Batch& value) {
    value.store_aligned(to_ + (row * IslSimd::columns + parameter) * width);
  }

  double* to_;
  const IslFactors& f_;
  Vector<Batch> e_;
};

inline Vector<Batch> spread(const Vector<double>& v) {
  return {Batch(v.x), Batch(v.y), Batch(v.z)};
}

void evaluate_batch(const double* input, const IslSimd::Fixed& fixed, const IslFactors& f,
                    double* output) {
  const IslParameters& p = fixed.parameters;
  const auto in = [&](int i) { return Batch::load_aligned(input + i * width); };
  const double* base = &p[isl_at::base];

  // Backwards: frames before each joint, seen in E. gammaB turns about the same axis as joint 1.
  Batch reading[6];
  Vector<Batch> x[5], z[6], origin[6];  // axes of the alpha_i and a_i, of the theta_i and d_i
  for (int i = 0; i < 6; ++i) reading[i] = in(i);
  Axes<Batch> at = {spread(fixed.last.x), spread(fixed.last.y), spread(fixed.last.z),
                    spread(fixed.last.origin)};
  z[5] = at.z;
  {
    const auto [s, c] = xsimd::sincos(p[isl_at::slope + 5] * reading[5]);
    unturn(at.x, at.y, s, c);
  }
  for (int i = 4; i >= 0; --i) {
    origin[i + 1] = at.origin;
    x[i] = at.x;
    unturn(at.y, at.z, Batch(fixed.sin_alpha[i]), Batch(fixed.cos_alpha[i]));
    z[i] = at.z;
    unshift(at.origin, at.x, p[isl_at::a + i]);
    unshift(at.origin, at.z, p[isl_at::d + i]);
    const double offset = p[isl_at::intercept + i] + (i == 0 ? base[5] : 0);
    const auto [s, c] = xsimd::sincos(p[isl_at::slope + i] * reading[i] + offset);
    unturn(at.x, at.y, s, c);
  }
  origin[0] = at.origin;
  const Vector<Batch> beta_b = at.x;
  unturn(at.y, at.z, Batch(fixed.sin_base[1]), Batch(fixed.cos_base[1]));
  const Vector<Batch> alpha_b = at.z;
  unturn(at.x, at.y, Batch(fixed.sin_base[0]), Batch(fixed.cos_base[0]));

  // T_err: the measured frame seen in E. The axes of B seen there are the columns of R_model^T.
  const auto see = [&](const Batch& a, const Batch& b, const Batch& c) {
    return Vector<Batch>{at.x.x * a + at.y.x * b + at.z.x * c, at.x.y * a + at.y.y * b + at.z.y * c,
                         at.x.z * a + at.y.z * b + at.z.z * c};
  };
  const Vector<Batch> e1 = see(in(6), in(9), in(12)), e2 = see(in(7), in(10), in(13)),
                      e3 = see(in(8), in(11), in(14));
  Vector<Batch> e = see(in(15) - base[0], in(16) - base[1], in(17) - base[2]);
  e = {e.x + at.origin.x, e.y + at.origin.y, e.z + at.origin.z};

  Columns to(output, f, e);
  to.column(isl_parameters, {{e.x * f[0], e.y * f[1], e.z * f[2], xsimd::atan2(e2.z, e2.y) * f[3],
                              xsimd::atan2(e3.x, e3.z) * f[4], xsimd::atan2(e1.y, e1.x) * f[5]}});
  const Batch kx = e2.x * f[3] / (e2.y * e2.y + e2.z * e2.z);
  const Batch ky = e3.y * f[4] / (e3.x * e3.x + e3.z * e3.z);
  const Batch kz = e1.z * f[5] / (e1.x * e1.x + e1.y * e1.y);
  to.xy = kx * e2.y, to.xz = kx * e2.z;
  to.yx = ky * e3.x, to.yz = ky * e3.z;
  to.zx = kz * e1.x, to.zy = kz * e1.y;

  to.shift(isl_at::base + 0, at.x);
  to.shift(isl_at::base + 1, at.y);
  to.shift(isl_at::base + 2, at.z);
  to.turn(isl_at::base + 3, alpha_b, origin[0]);
  to.turn(isl_at::base + 4, beta_b, origin[0]);
  for (int i = 0; i < 5; ++i) {
    const Columns::Column theta = to.turn(isl_at::intercept + i, z[i], origin[i]);
    to.scaled(isl_at::slope + i, theta, reading[i]);
    if (i == 0) to.column(isl_at::base + 5, theta);
    to.shift(isl_at::d + i, z[i]);
    to.shift(isl_at::a + i, x[i]);
    to.turn(isl_at::alpha + i, x[i], origin[i + 1]);
  }
  const Columns::Column theta = to.turn(isl_at::end + 3, z[5], spread({0, 0, 0}));
  // Joint 6 turns about the same direction as alphaE, through the origin of frame 6.
  const Vector<Batch> arm = {e.x - origin[5].x, e.y - origin[5].y, e.z - origin[5].z};
  to.scaled(
      isl_at::slope + 5,
      {{(arm.y * z[5].z - arm.z * z[5].y) * f[0], (arm.z * z[5].x - arm.x * z[5].z) * f[1],
        (arm.x * z[5].y - arm.y * z[5].x) * f[2], theta.rows[3], theta.rows[4], theta.rows[5]}},
      reading[5]);
  to.shift(isl_at::end + 0, spread(fixed.last.x));
  to.shift(isl_at::end + 1, spread(fixed.last.y));
  to.shift(isl_at::end + 2, z[5]);
  to.about(isl_at::end + 4, spread(fixed.beta_e), e);
  to.about(isl_at::end + 5, spread({0, 0, 1}), e);
}

}  // namespace

const int IslSimd::lanes = width;

void IslSimd::Free::operator()(double* p) const { std::free(p); }

IslSimd::IslSimd(const IslPoses& poses, const IslFactors& factors)
    : factors_(factors),
      poses_(static_cast<int>(poses.size())),
      batches_((static_cast<int>(poses.size()) + width - 1) / width),
      input_(static_cast<double*>(
          std::aligned_alloc(64, (sizeof(double) * batches_ * inputs * width + 63) / 64 * 64))) {
  if (!input_) throw std::bad_alloc();
  for (int i = 0; i < batches_ * width; ++i) {
    const IslPose& pose = poses[std::min<std::size_t>(i, poses.size() - 1)];
    double* to = &input_[static_cast<std::size_t>(i / width) * inputs * width + i % width];
    for (double v : pose.readings) *to = v, to += width;
    for (double v : pose.rotation) *to = v, to += width;
    for (double v : pose.position) *to = v, to += width;
  }
}

IslSimd::~IslSimd() = default;

void IslSimd::set(const IslParameters& parameters) { fixed_ = std::make_unique<Fixed>(parameters); }

void IslSimd::evaluate(int first, int count, double* rows) const {
  constexpr int size = isl_rows * columns * width;
  for (int i = 0; i < count; ++i)
    evaluate_batch(&input_[static_cast<std::size_t>(first + i) * inputs * width], *fixed_, factors_,
                   rows + i * size);
  if (first + count < batches_) return;
  double* last = rows + (count - 1) * size;
  for (int lane = poses_ - (batches_ - 1) * width; lane < width; ++lane)
    for (int i = 0; i < isl_rows * columns; ++i) last[i * width + lane] = 0;
}

}  // namespace talus::bench
