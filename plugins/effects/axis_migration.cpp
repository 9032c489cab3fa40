#include "framework/registry/bind.h"

namespace talus {
namespace {

// The axis is not fixed in the body: its place shifts, or its direction tilts, as the joint turns
// (femoral roll-back of the knee, the talocrural joint; Walker 1988, Sheehan 2010).
struct AxisMigration {
  static Declaration declaration() {
    return effect("axis_migration", Acts::about,
                  "axis moves with the angle q: it shifts (x, y) and tilts about x and y, by so "
                  "much times q/per, and by the squared ones times (q/per)^2")
        .on(angle)
        .amount("x", length, 3, "shift along x of the axis frame at q = per")
        .amount("y", length, 3, "shift along y")
        .amount("tilt_x", angle, 3 * deg, "tilt about x at q = per")
        .amount("tilt_y", angle, 3 * deg, "tilt about y")
        .amount("x_squared", length, 1, "further shift along x, with the square of q/per")
        .amount("y_squared", length, 1, "further shift along y")
        .amount("tilt_x_squared", angle, 1 * deg, "further tilt about x")
        .amount("tilt_y_squared", angle, 1 * deg, "further tilt about y")
        .setting("per", angle, 30 * deg, {}, "angle to which the amounts refer")
        .form({"x", "y"})
        .form({"tilt_x", "tilt_y"})
        .form({"x", "y", "tilt_x", "tilt_y"})
        .shown(magnitude("shift", "direction", {"x", "y"}))
        .shown(magnitude("tilt", "direction", {"tilt_x", "tilt_y"}));
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T x, T y, T tilt_x, T tilt_y, T x_squared,
                      T y_squared, T tilt_x_squared, T tilt_y_squared, T per) {
    const T q = around.coordinate / per, q2 = q * q;
    return {{x * q + x_squared * q2, y * q + y_squared * q2, T(0)},
            {tilt_x * q + tilt_x_squared * q2, tilt_y * q + tilt_y_squared * q2, T(0)}};
  }
};
TALUS_PLUGIN(AxisMigration)

}  // namespace
}  // namespace talus
