#include "framework/registry/bind.h"

namespace talus {
namespace {

// Ball joint about the point p of A: T_A_B = Trans(p) Rz(yaw) Ry(pitch) Rx(roll) Trans(-p)
// (Storey 2006, eqs 3-5, for the three rotations). Singular at pitch = +-90 deg.
struct Spherical {
  static Declaration declaration() {
    return joint("spherical",
                 "ball joint about a point: Trans(p) Rz(yaw) Ry(pitch) Rx(roll) Trans(-p) "
                 "(rotations: Storey 2006, eqs 3-5)")
        .coordinate("roll", angle, "rotation about x")
        .coordinate("pitch", angle, "rotation about y")
        .coordinate("yaw", angle, "rotation about z")
        .input("x", length, 0, "x of the ball's centre in A")
        .input("y", length, 0, "y of it")
        .input("z", length, 0, "z of it");
  }
  template <class T>
  static Rigid<T> transform(T roll, T pitch, T yaw, T x, T y, T z) {
    return translate(x, y, z) * rotate_rpy(roll, pitch, yaw) * translate(-x, -y, -z);
  }
};
TALUS_PLUGIN(Spherical)

}  // namespace
}  // namespace talus
