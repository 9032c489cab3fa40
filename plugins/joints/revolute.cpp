#include "framework/registry/bind.h"

namespace talus {
namespace {

// Hinge about an arbitrary axis given in A, which leaves A and B in one place at theta = 0:
// T_A_B = Trans(p) Rx(roll) Ry(yaw) Rz(theta) Ry(-yaw) Rx(-roll) Trans(-p).
// The axis passes through p along Rx(roll) Ry(yaw) (0,0,1)^T (Storey 2006, sec. IV).
struct Revolute {
  static Declaration declaration() {
    return joint("revolute",
                 "hinge about any axis: H Rz(theta) inverse(H), H = Trans(p) Rx(roll) Ry(yaw) "
                 "(Storey 2006, sec. IV)")
        .coordinate("theta", angle, "rotation about the axis")
        .input("x", length, 0, "x of a point of the axis, in A")
        .input("y", length, 0, "y of that point")
        .input("z", length, 0, "z of that point")
        .input("roll", angle, 0, "first turn of the axis away from z of A, about x of A")
        .input("yaw", angle, 0, "second turn, about the turned y");
  }
  template <class T>
  static Rigid<T> transform(T theta, T x, T y, T z, T roll, T yaw) {
    const Rigid<T> axis = translate(x, y, z) * rotate_x(roll) * rotate_y(yaw);
    return axis * rotate_z(theta) * inverse(axis);
  }
};
TALUS_PLUGIN(Revolute)

}  // namespace
}  // namespace talus
