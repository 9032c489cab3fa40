#include "framework/registry/bind.h"

namespace talus {
namespace {

// Hinge about an axis given by a point p and a vector u of any length but zero:
// T_A_B = Trans(p) exp(theta [u/|u|]) Trans(-p), by Rodrigues' formula
// (Murray, Li and Sastry, A Mathematical Introduction to Robotic Manipulation, 1994, ch. 2).
struct RevoluteAbout {
  static Declaration declaration() {
    return joint("revolute_about",
                 "hinge about the axis through p along u: Trans(p) exp(theta [u/|u|]) Trans(-p) "
                 "(Murray, Li and Sastry 1994, ch. 2)")
        .coordinate("theta", angle, "rotation about the axis")
        .input("x", length, 0, "x of a point of the axis, in A")
        .input("y", length, 0, "y of that point")
        .input("z", length, 0, "z of that point")
        .input("ux", number, 0, "x of a vector along the axis, in A; its length is of no matter")
        .input("uy", number, 0, "y of that vector")
        .input("uz", number, 1, "z of that vector");
  }
  template <class T>
  static Rigid<T> transform(T theta, T x, T y, T z, T ux, T uy, T uz) {
    return translate(x, y, z) * rotate_about(ux, uy, uz, theta) * translate(-x, -y, -z);
  }
};
TALUS_PLUGIN(RevoluteAbout)

}  // namespace
}  // namespace talus
