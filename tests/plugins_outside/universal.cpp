#include <framework/registry/bind.h>

namespace talus {

// Universal (Cardan, Hooke) joint: two axes, nominally crossing at right angles. The second is
// `offset` away along their common normal and `skew` off the right angle.
// T_A_B = Rz(bend) Tx(offset) Rx(pi/2 + skew) Rz(twist)
struct Universal {
  static Declaration declaration() {
    return joint("universal", "universal joint: Rz(bend) Tx(offset) Rx(90 deg + skew) Rz(twist)")
        .coordinate("bend", angle, "rotation about z of A")
        .coordinate("twist", angle, "rotation about z of B")
        .input("offset", length, 0, "common normal from the first axis to the second")
        .input("skew", angle, 0, "what the angle between the axes has beyond 90 deg");
  }
  template <class T>
  static Rigid<T> transform(T bend, T twist, T offset, T skew) {
    return rotate_z(bend) * translate_x(offset) * rotate_x(T(90 * deg) + skew) * rotate_z(twist);
  }
};
TALUS_PLUGIN(Universal)

}  // namespace talus
