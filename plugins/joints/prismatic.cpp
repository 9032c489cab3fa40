#include "framework/registry/bind.h"

namespace talus {
namespace {

// Slide along an arbitrary direction of A:
// T_A_B = Rx(roll) Ry(yaw) Tz(d) Ry(-yaw) Rx(-roll), the direction being Rx(roll) Ry(yaw) (0,0,1)^T
// (the twist of zero rotation: Murray, Li and Sastry 1994, ch. 2; angles as in Storey 2006).
struct Prismatic {
  static Declaration declaration() {
    return joint("prismatic",
                 "slide along any direction: H Tz(d) inverse(H), H = Rx(roll) Ry(yaw) (Murray, Li "
                 "and Sastry 1994, ch. 2)")
        .coordinate("d", length, "way along the direction")
        .input("roll", angle, 0, "first turn of the direction away from z of A, about x of A")
        .input("yaw", angle, 0, "second turn, about the turned y");
  }
  template <class T>
  static Rigid<T> transform(T d, T roll, T yaw) {
    const Rigid<T> direction = rotate_x(roll) * rotate_y(yaw);
    return direction * translate_z(d) * inverse(direction);
  }
};
TALUS_PLUGIN(Prismatic)

}  // namespace
}  // namespace talus
