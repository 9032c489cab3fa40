#include "framework/registry/bind.h"

namespace talus {
namespace {

// Screw: a hinge that moves along its axis in proportion to its angle,
// T_A_B = H Rz(theta) Tz(pitch theta) H^-1 with H = Trans(p) Rx(roll) Ry(yaw)
// (Murray, Li and Sastry 1994, ch. 2). Pitch 0 is `revolute`.
struct Screw {
  static Declaration declaration() {
    return joint("screw",
                 "screw about any axis: H Rz(theta) Tz(pitch theta) inverse(H), H = Trans(p) "
                 "Rx(roll) Ry(yaw) (Murray, Li and Sastry 1994, ch. 2)")
        .coordinate("theta", angle, "rotation about the axis")
        .input("pitch", length / angle, 0, "way along the axis per angle")
        .input("x", length, 0, "x of a point of the axis, in A")
        .input("y", length, 0, "y of that point")
        .input("z", length, 0, "z of that point")
        .input("roll", angle, 0, "first turn of the axis away from z of A, about x of A")
        .input("yaw", angle, 0, "second turn, about the turned y");
  }
  template <class T>
  static Rigid<T> transform(T theta, T pitch, T x, T y, T z, T roll, T yaw) {
    const Rigid<T> axis = translate(x, y, z) * rotate_x(roll) * rotate_y(yaw);
    return axis * rotate_z(theta) * translate_z(pitch * theta) * inverse(axis);
  }
};
TALUS_PLUGIN(Screw)

}  // namespace
}  // namespace talus
