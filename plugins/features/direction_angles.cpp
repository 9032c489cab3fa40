#include "framework/registry/bind.h"

namespace talus {
namespace {

// A measured direction given by its angles to the three axes of frame `in` (inverse direction
// cosines, Nordquist and Hull 2009, eqs 6-8), as measured: three numbers for two degrees of
// freedom.
struct DirectionAngles {
  static Declaration declaration() {
    return feature("direction_angles", Kind::direction,
                   "measured direction: its angles to the axes of frame `in`, inverse direction "
                   "cosines (Nordquist 2009, eqs 6-8)")
        .input("roll", angle, 0, "first turn of the direction away from z of `at`, about x of `at`")
        .input("yaw", angle, 0, "second turn, about the turned y")
        .column("x", angle)
        .column("y", angle)
        .column("z", angle)
        .judged_by({"inverse_direction_cosines"});
  }
  template <class T>
  static Rigid<T> offset(T roll, T yaw) {
    return rotate_x(roll) * rotate_y(yaw);
  }
  template <class T>
  static Observed<T> observe(T x, T y, T z) {
    return {.kind = Kind::direction, .vector = {x, y, z}, .angles = true};
  }
};
TALUS_PLUGIN(DirectionAngles)

}  // namespace
}  // namespace talus
