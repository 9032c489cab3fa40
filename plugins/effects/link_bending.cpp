// Links that give way under the static load at their end, and under their own weight.
#include "framework/registry/bind.h"

namespace talus {
namespace {

constexpr double kShortest = 20;  // mm: what is shorter is a joint's body rather than a beam

// Cantilever from the frame before the joint to the frame behind it, of one flexibility 1/(EI) in
// all directions across; own weight evenly spread (Euler and Bernoulli):
// deflection F L^3/3 + M L^2/2 + W L^3/8, slope F L^2/2 + M L + W L^2/6, each times 1/(EI).
template <class T>
Twist<T> cantilever(const Around<T>& around, T flexibility) {
  const Vector3<T>& s = around.span;
  const T L2 = dot(s, s) + T(1e-12), L = safe_sqrt(L2), slender = less(T(kShortest), L);
  auto across = [&](const Vector3<T>& v) {
    const T along = dot(v, s) / L2;
    return Vector3<T>{v[0] - along * s[0], v[1] - along * s[1], v[2] - along * s[2]};
  };
  const Vector3<T> F = across(around.tip_force), M = across(around.tip_moment),
                   W = across(around.weight);
  // A moment M about an axis across bends the end along M x s; a force F turns it about s x F.
  const Vector3<T> by_moment = cross(M, s), by_force = cross(s, F), by_weight = cross(s, W);
  Twist<T> twist;
  for (int i = 0; i < 3; ++i) {
    twist.translation[i] = slender * flexibility *
                           (F[i] * L2 * L / T(3) + by_moment[i] * L / T(2) + W[i] * L2 * L / T(8));
    twist.rotation[i] =
        slender * flexibility * (by_force[i] * L / T(2) + M[i] * L + by_weight[i] * L / T(6));
  }
  return twist;
}

struct LinkBending {
  static Declaration declaration() {
    return effect("link_bending", Acts::link, "link bends as a cantilever of flexibility 1/(EI)")
        .amount("flexibility", number / (torque * length), 0.1 / 1e9, "1/(EI)")
        .usual_size(0.1, 0.03 * deg)
        .shown(renamed("flexibility", "flexibility", "1/(N*m^2)"))
        .needs(Covariate::tip_load)
        .reference("Euler-Bernoulli beam");
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T flexibility) {
    return cantilever(around, flexibility);
  }
};
TALUS_PLUGIN(LinkBending)

// Printed links give way further while they stay loaded.
struct Creep {
  static Declaration declaration() {
    return effect("creep", Acts::link,
                  "bending that grows with the time in the session: flexibility log(1 + t/tau)")
        .amount("flexibility", number / (torque * length), 0.01 / 1e9, "1/(EI) per unit of the log")
        .setting("tau", duration, 600, {600}, "time after which it begins to slow down")
        .usual_size(0.03, 0.01 * deg)
        .shown(renamed("flexibility", "flexibility", "1/(N*m^2)"))
        .needs(Covariate::tip_load)
        .needs(Covariate::since);
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T flexibility, T tau) {
    using std::log;
    return cantilever(around, flexibility * log(T(1) + around.since / tau));
  }
};
TALUS_PLUGIN(Creep)

struct LinkTorsion {
  static Declaration declaration() {
    return effect("link_torsion", Acts::link,
                  "link twists about the line from joint to joint: flexibility 1/(GJ)")
        .amount("flexibility", number / (torque * length), 0.1 / 1e9, "1/(GJ)")
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
