#include "framework/registry/bind.h"

namespace talus {
namespace {

// Distal Denavit-Hartenberg joint with a fifth number for (nearly) parallel consecutive axes, where
// d is not determined: T_A_B = Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta).
// Hayati and Mirmirani, J. Robotic Systems 2 (1985), p. 397.
struct DhHayati {
  static Declaration declaration() {
    return joint("dh_hayati",
                 "Denavit-Hartenberg joint for nearly parallel axes: Rz(theta) Tz(d) Tx(a) "
                 "Rx(alpha) Ry(beta) (Hayati and Mirmirani 1985)")
        .coordinate("theta", angle, "rotation about z of A")
        .input("d", length, 0, "offset along z of A; keep it fixed where beta is free")
        .input("a", length, 0, "length along x, after the rotation by theta")
        .input("alpha", angle, 0, "twist about that x")
        .input("beta", angle, 0, "second twist, about y of B");
  }
  template <class T>
  static Rigid<T> transform(T theta, T d, T a, T alpha, T beta) {
    return rotate_z(theta) * translate_z(d) * translate_x(a) * rotate_x(alpha) * rotate_y(beta);
  }
};
TALUS_PLUGIN(DhHayati)

}  // namespace
}  // namespace talus
