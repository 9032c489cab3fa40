#include "framework/registry/bind.h"

namespace talus {
namespace {

// A measured direction: its components in frame `in` (of any length but zero, made a unit vector);
// the direction itself is Rx(roll) Ry(yaw) (0,0,1)^T of frame `at`.
struct Direction {
  static Declaration declaration() {
    return feature("direction", Kind::direction,
                   "measured direction: components in frame `in` of the z axis of Rx(roll) Ry(yaw) "
                   "in frame `at` (angles: Storey 2006)")
        .input("roll", angle, 0, "first turn of the direction away from z of `at`, about x of `at`")
        .input("yaw", angle, 0, "second turn, about the turned y")
        .column(".x", number)
        .column(".y", number)
        .column(".z", number)
        .judged_by({"direction"});
  }
  template <class T>
  static Rigid<T> offset(T roll, T yaw) {
    return rotate_x(roll) * rotate_y(yaw);
  }
  template <class T>
  static Observed<T> observe(T x, T y, T z) {
    const T size = norm<T>({x, y, z});
    return {.kind = Kind::direction, .vector = {x / size, y / size, z / size}};
  }
};
TALUS_PLUGIN(Direction)

}  // namespace
}  // namespace talus
