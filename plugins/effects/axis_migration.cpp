#include "framework/registry/bind.h"

namespace talus {
namespace {

// The axis is not fixed in the body: its place shifts, or its direction tilts, as the joint turns
// (femoral roll-back of the knee, the talocrural joint; Walker 1988, Sheehan 2010).
struct AxisMigration {
  static Declaration declaration() {
    return effect("axis_migration", Acts::about,
                  "axis moves with the angle q: shift (x, y), or tilt about x and y, times q/per")
        .on(angle)
        .amount("x", length, 3, "shift along x of the axis frame at q = per")
        .amount("y", length, 3, "shift along y")
        .amount("tilt_x", angle, 3 * deg, "tilt about x at q = per")
        .amount("tilt_y", angle, 3 * deg, "tilt about y")
        .setting("per", angle, 30 * deg, {}, "angle to which the amounts refer")
        .form({"x", "y"})
        .form({"tilt_x", "tilt_y"})
        .shown(magnitude("shift", "direction", {"x", "y"}))
        .shown(magnitude("tilt", "direction", {"tilt_x", "tilt_y"}));
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T x, T y, T tilt_x, T tilt_y, T per) {
    const T q = around.coordinate / per;
    return {{x * q, y * q, T(0)}, {tilt_x * q, tilt_y * q, T(0)}};
  }
};
TALUS_PLUGIN(AxisMigration)

}  // namespace
}  // namespace talus
