#include "framework/registry/bind.h"

namespace talus {
namespace {

// Placement of a linkage on what carries it: T_A_B = Trans(x, y, z) R(a, b, c). The rotation is
// "zxz": Rz(a) Rx(b) Rz(c) (Bonny 2013, eq. 2); "rpy": Rz(c) Ry(b) Rx(a), a roll, b pitch, c yaw
// (Storey 2006, eqs 3-5); "vector": exp of the rotation vector (a, b, c), which has no singular
// place below half a turn. It has two names: `mount` at the ends of a chain, `fixed` inside one.
struct Placement {
  static Declaration six_numbers(const char* tag, const char* summary) {
    return joint(tag, summary)
        .input("x", length, 0, "x of the origin of B in A")
        .input("y", length, 0, "y of it")
        .input("z", length, 0, "z of it")
        .input("a", angle, 0,
               "first angle: about z (zxz), roll (rpy), x of the rotation vector (vector)")
        .input("b", angle, 0, "second angle: about x (zxz), pitch (rpy), y of the vector")
        .input("c", angle, 0, "third angle: about z (zxz), yaw (rpy), z of the vector")
        .choice("order", {"zxz", "rpy", "vector"},
                "Rz(a) Rx(b) Rz(c), Rz(c) Ry(b) Rx(a), or exp(a, b, c)");
  }
  template <class T>
  static Rigid<T> transform(T x, T y, T z, T a, T b, T c, int order) {
    return translate(x, y, z) * (order == 0   ? rotate_zxz(a, b, c)
                                 : order == 1 ? rotate_rpy(a, b, c)
                                              : rotate_by_vector(a, b, c));
  }
};

struct Mount : Placement {
  static Declaration declaration() {
    return six_numbers("mount",
                       "where a linkage is mounted: a placement by six numbers, Trans(x,y,z) and a "
                       "rotation (Bonny 2013, eq. 2)");
  }
};
TALUS_PLUGIN(Mount)

struct Fixed : Placement {
  static Declaration declaration() {
    return six_numbers(
        "fixed", "rigid link between two frames: Trans(x,y,z) and a rotation (Bonny 2013, eq. 2)");
  }
};
TALUS_PLUGIN(Fixed)

}  // namespace
}  // namespace talus
