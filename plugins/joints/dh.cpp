#include "framework/registry/bind.h"

namespace talus {
namespace {

// Distal (standard) Denavit-Hartenberg joint: T_A_B = Rz(theta) Tz(d) Tx(a) Rx(alpha).
struct Dh {
  static Declaration declaration() {
    return joint("dh",
                 "Denavit-Hartenberg joint, distal form: Rz(theta) Tz(d) Tx(a) Rx(alpha) (Bonny "
                 "2013, sec. 2.1)")
        .coordinate("theta", angle, "rotation about z of A")
        .input("d", length, 0, "offset along z of A")
        .input("a", length, 0, "length along x of B")
        .input("alpha", angle, 0, "twist about x of B");
  }
  template <class T>
  static Rigid<T> transform(T theta, T d, T a, T alpha) {
    return rotate_z(theta) * translate_z(d) * translate_x(a) * rotate_x(alpha);
  }
};
TALUS_PLUGIN(Dh)

}  // namespace
}  // namespace talus
