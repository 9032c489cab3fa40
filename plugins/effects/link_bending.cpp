// Links that give way under the static load at their end, and under their own weight.
#include "framework/registry/bind.h"

namespace talus {
namespace {

constexpr double kShortest = 20;  // mm: what is shorter is a joint's body rather than a beam

// Cantilever from the frame before the joint to the frame behind it, of one flexibility f = 1/(EI)
// in all directions across (Euler and Bernoulli): deflection F L^3/3 + M L^2/2 + W L^3/8, slope
// F L^2/2 + M L + W L^2/6, each times f. Not quite that: an oval section, softer one way across
// than the other; and own weight W centred off the middle of the line, by o/f, so that it also
// bends by its moment N = o x W, spread along the line: deflection N L^2/3, slope N L/2.
template <class T>
Twist<T> cantilever(const Around<T>& around, T flexibility, T oval, const Vector3<T>& off) {
  const Vector3<T>& s = around.span;
  const T L2 = dot(s, s) + T(1e-12), L = safe_sqrt(L2), slender = less(T(kShortest), L);
  // What bends that way, times the flexibility along each axis of the link's frame.
  auto bent = [&](const Vector3<T>& v) {
    Vector3<T> u;
    const T along = dot(v, s) / L2;
    for (int i = 0; i < 3; ++i) {
      const T &a = s[(i + 1) % 3], &b = s[(i + 2) % 3];
      u[i] = (v[i] - along * s[i]) * (flexibility + oval * (a * a - b * b) / L2);
    }
    const T out = dot(u, s) / L2;
    for (int i = 0; i < 3; ++i) u[i] = u[i] - out * s[i];
    return u;
  };
  // A moment about an axis across bends the end along moment x s.
  const Vector3<T> F = bent(around.tip_force), W = bent(around.weight),
                   M = bent(cross(around.tip_moment, s)), N = cross(cross(off, around.weight), s);
  Vector3<T> slope;
  Twist<T> twist;
  for (int i = 0; i < 3; ++i) {
    twist.translation[i] =
        slender * (F[i] * L2 * L / T(3) + M[i] * L / T(2) + W[i] * L2 * L / T(8) + N[i] * L / T(3));
    slope[i] = F[i] * L / T(2) + M[i] / L + W[i] * L / T(6) + N[i] / (T(2) * L);
  }
  // An end that is bent that way turns about s x that way.
  const Vector3<T> turn = cross(s, slope);
  for (int i = 0; i < 3; ++i) twist.rotation[i] = slender * turn[i];
  return twist;
}

struct LinkBending {
  static Declaration declaration() {
    const Dimension unit = number / (torque * length);
    return effect("link_bending", Acts::link, "link bends as a cantilever of flexibility 1/(EI)")
        .amount("flexibility", unit, 0.1 / 1e9, "1/(EI)")
        .amount("oval", unit, 0.05 / 1e9, "half the difference between two axes across")
        .amount("off_x", number / torque, 5 / 1e9,
                "own weight's centre off the middle of the line, times the flexibility, along x")
        .amount("off_y", number / torque, 5 / 1e9, "along y")
        .amount("off_z", number / torque, 5 / 1e9, "along z")
        .form({"flexibility"})
        .form({"flexibility", "oval", "off_x", "off_y", "off_z"})
        .usual_size(0.1, 0.03 * deg)
        .shown(renamed("flexibility", "flexibility", "1/(N*m^2)"))
        .shown(renamed("oval", "oval", "1/(N*m^2)"))
        .shown(magnitude("off", "direction", {"off_x", "off_y", "off_z"}))
        .needs(Covariate::tip_load)
        .reference("Euler-Bernoulli beam");
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T flexibility, T oval, T off_x, T off_y, T off_z) {
    return cantilever(around, flexibility, oval, {off_x, off_y, off_z});
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
    return cantilever(around, flexibility * log(T(1) + around.since / tau), T(0),
                      {T(0), T(0), T(0)});
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
