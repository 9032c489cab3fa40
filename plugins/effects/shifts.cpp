// Something moved and stayed where it went, or keeps moving: a clamp, the fixture, the mount.
#include "framework/registry/bind.h"

namespace talus {
namespace {

Declaration six(Declaration d, Dimension per, double mm, double angle_size) {
  return d.amount("x", length / per, mm, "along x")
      .amount("y", length / per, mm, "along y")
      .amount("z", length / per, mm, "along z")
      .amount("rx", angle / per, angle_size, "about x")
      .amount("ry", angle / per, angle_size, "about y")
      .amount("rz", angle / per, angle_size, "about z");
}

template <class T>
Twist<T> times(const T& by, T x, T y, T z, T rx, T ry, T rz) {
  return {{by * x, by * y, by * z}, {by * rx, by * ry, by * rz}};
}

struct ClampSlip {
  static Declaration declaration() {
    return six(effect("clamp_slip", Acts::link, "the end of a link slips from one pose on"), number,
               0.1, 0.05 * deg)
        .onset("pose", Covariate::pose, "number of the first pose after it")
        .shown(magnitude("translation", "", {"x", "y", "z"}))
        .shown(magnitude("rotation", "", {"rx", "ry", "rz"}));
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T x, T y, T z, T rx, T ry, T rz, T pose) {
    return times(T(1) - less(around.pose, pose), x, y, z, rx, ry, rz);
  }
};
TALUS_PLUGIN(ClampSlip)

struct FixtureShift {
  static Declaration declaration() {
    return six(effect("fixture_shift", Acts::fixture,
                      "fixture or instrument stands elsewhere from one session on"),
               number, 0.1, 0.05 * deg)
        .onset("session", Covariate::session, "number of the first session after it")
        .shown(magnitude("translation", "", {"x", "y", "z"}))
        .shown(magnitude("rotation", "", {"rx", "ry", "rz"}));
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T x, T y, T z, T rx, T ry, T rz, T session) {
    return times(T(1) - less(around.session, session), x, y, z, rx, ry, rz);
  }
};
TALUS_PLUGIN(FixtureShift)

struct MountDrift {
  static Declaration declaration() {
    return six(effect("mount_drift", Acts::fixture, "fixture or instrument creeps with the time"),
               duration, 0.02 / 3600, 0.01 * deg / 3600)
        .needs(Covariate::time)
        .shown(magnitude("translation", "", {"x", "y", "z"}))
        .shown(magnitude("rotation", "", {"rx", "ry", "rz"}));
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T x, T y, T z, T rx, T ry, T rz) {
    return times(around.time, x, y, z, rx, ry, rz);
  }
};
TALUS_PLUGIN(MountDrift)

}  // namespace
}  // namespace talus
