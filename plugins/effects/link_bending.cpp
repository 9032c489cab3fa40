// Links that give way under the static load at their end, and under their own weight.
#include "framework/registry/bind.h"

namespace talus {
namespace {

constexpr double kShortest = 20;  // mm: what is shorter is a joint's body rather than a beam

// Cantilever from the frame before the joint to the frame behind it (Euler and Bernoulli):
// deflection F L^3/3 + M L^2/2 + W L^3/8, slope F L^2/2 + M L + W L^2/6, each times 1/(EI). The own
// weight W is evenly spread along the line from joint to joint. Where it lies beside that line its
// moment N is spread as well: deflection N L^2/3, slope N L/2, times a flexibility of its own.
// An oval section is softer one way across than the other.
template <class T>
Twist<T> cantilever(const Around<T>& around, T flexibility, T beside, T oval) {
  const Vector3<T>& s = around.span;
  const T L2 = dot(s, s) + T(1e-12), L = safe_sqrt(L2), slender = less(T(kShortest), L);
  auto across = [&](const Vector3<T>& v) {
    const T along = dot(v, s) / L2;
    return Vector3<T>{v[0] - along * s[0], v[1] - along * s[1], v[2] - along * s[2]};
  };
  // Flexibility that way: along an axis of the link's frame, nothing on the line itself.
  auto softened = [&](const Vector3<T>& v, T even) {
    Vector3<T> u;
    for (int i = 0; i < 3; ++i) {
      const T &a = s[(i + 1) % 3], &b = s[(i + 2) % 3];
      u[i] = v[i] * (even + oval * (a * a - b * b) / L2);
    }
    return across(u);
  };
  // A moment M about an axis across bends the end along M x s.
  const Vector3<T> half{s[0] / T(2), s[1] / T(2), s[2] / T(2)}, swung = cross(half, around.weight);
  Vector3<T> own;
  for (int i = 0; i < 3; ++i) own[i] = around.own_moment[i] + swung[i];
  const Vector3<T> F = softened(across(around.tip_force), flexibility),
                   W = softened(across(around.weight), flexibility),
                   M = softened(cross(around.tip_moment, s), flexibility);
  const Vector3<T> N = cross(own, s);
  Vector3<T> slope;
  Twist<T> twist;
  for (int i = 0; i < 3; ++i) {
    const T n = beside * N[i];
    twist.translation[i] =
        slender * (F[i] * L2 * L / T(3) + M[i] * L / T(2) + W[i] * L2 * L / T(8) + n * L / T(3));
    slope[i] = F[i] * L / T(2) + M[i] / L + W[i] * L / T(6) + n / (T(2) * L);
  }
  // Displaced that way, the end turns about s x that way.
  const Vector3<T> turn = cross(s, slope);
  for (int i = 0; i < 3; ++i) twist.rotation[i] = slender * turn[i];
  return twist;
}

struct LinkBending {
  static Declaration declaration() {
    return effect("link_bending", Acts::link, "link bends as a cantilever of flexibility 1/(EI)")
        .amount("flexibility", number / (torque * length), 0.1 / 1e9, "1/(EI)")
        .not_negative()
        .amount("beside", number / (torque * length), 0.1 / 1e9,
                "1/(EI) for the moment of its own weight where that lies beside its line")
        .not_negative()
        .amount("oval", number / (torque * length), 0.03 / 1e9,
                "how much softer it is along one axis of its frame than along the other")
        .form({"flexibility"})
        .form({"flexibility", "beside", "oval"})
        .usual_size(0.1, 0.03 * deg)
        .shown(renamed("flexibility", "flexibility", "1/(N*m^2)"))
        .shown(renamed("beside", "beside", "1/(N*m^2)"))
        .shown(renamed("oval", "oval", "1/(N*m^2)"))
        .needs(Covariate::tip_load)
        .reference("Euler-Bernoulli beam");
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T flexibility, T beside, T oval) {
    return cantilever(around, flexibility, beside, oval);
  }
};
TALUS_PLUGIN(LinkBending)

// Printed links give way further while they stay loaded.
struct Creep {
  static Declaration declaration() {
    return effect("creep", Acts::link,
                  "bending that grows with the time in the session: flexibility log(1 + t/tau)")
        .amount("flexibility", number / (torque * length), 0.01 / 1e9, "1/(EI) per unit of the log")
        .not_negative()
        .setting("tau", duration, 600, {600}, "time after which it begins to slow down")
        .usual_size(0.03, 0.01 * deg)
        .shown(renamed("flexibility", "flexibility", "1/(N*m^2)"))
        .needs(Covariate::tip_load)
        .needs(Covariate::since);
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T flexibility, T tau) {
    using std::log;
    return cantilever(around, flexibility * log(T(1) + around.since / tau), T(0), T(0));
  }
};
TALUS_PLUGIN(Creep)

struct LinkTorsion {
  static Declaration declaration() {
    return effect("link_torsion", Acts::link,
                  "link twists about the line from joint to joint: flexibility 1/(GJ)")
        .amount("flexibility", number / (torque * length), 0.1 / 1e9, "1/(GJ)")
        .not_negative()
        .usual_size(0, 0.03 * deg)
        .shown(renamed("flexibility", "flexibility", "1/(N*m^2)"))
        .needs(Covariate::tip_load);
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T flexibility) {
    const Vector3<T>& s = around.span;
    const T L = safe_sqrt(dot(s, s)) + T(1e-9),
            turn = less(T(kShortest), L) * flexibility * dot(around.tip_moment, s) / L;
    return {{}, {turn * s[0], turn * s[1], turn * s[2]}};
  }
};
TALUS_PLUGIN(LinkTorsion)

}  // namespace
}  // namespace talus
