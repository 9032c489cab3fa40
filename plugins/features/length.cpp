#include "framework/registry/bind.h"

namespace talus {
namespace {

// A measured length: the distance of the point (x, y, z) of frame `at` from the origin of frame
// `in` (vector length P of Nordquist and Hull 2009, eq. 9).
struct Length {
  static Declaration declaration() {
    return feature("length", Kind::scalar,
                   "measured distance of the point (x, y, z) of frame `at` from the origin of "
                   "frame `in` (Nordquist 2009, eq. 9)")
        .input("x", length, 0, "x of the point in frame `at`")
        .input("y", length, 0, "y of it")
        .input("z", length, 0, "z of it")
        .column("", length)
        .judged_by({"vector_length"});
  }
  template <class T>
  static Rigid<T> offset(T x, T y, T z) {
    return translate(x, y, z);
  }
  template <class T>
  static Observed<T> observe(T value) {
    return {.kind = Kind::scalar, .scalar = value};
  }
};
TALUS_PLUGIN(Length)

}  // namespace
}  // namespace talus
