#include "framework/registry/bind.h"

namespace talus {
namespace {

// Proximal (modified) Denavit-Hartenberg joint: T_A_B = Rx(alpha) Tx(a) Rz(theta) Tz(d). Length and
// twist stand before the rotation, not after it as in `dh`. It is the inverse of the coordinate
// change x_B = Rz(-theta) (Rx(-alpha) x_A - (a, 0, 0)) - (0, 0, d) of Nordquist and Hull 2009,
// eq. 2.
struct DhProximal {
  static Declaration declaration() {
    return joint("dh_proximal",
                 "Denavit-Hartenberg joint, proximal (modified) form: Rx(alpha) Tx(a) Rz(theta) "
                 "Tz(d) (Nordquist 2009, eq. 2)")
        .coordinate("theta", angle, "rotation about z of B")
        .input("d", length, 0, "offset along z of B")
        .input("a", length, 0, "length along x of A")
        .input("alpha", angle, 0, "twist about x of A");
  }
  template <class T>
  static Rigid<T> transform(T theta, T d, T a, T alpha) {
    return rotate_x(alpha) * translate_x(a) * rotate_z(theta) * translate_z(d);
  }
};
TALUS_PLUGIN(DhProximal)

}  // namespace
}  // namespace talus
