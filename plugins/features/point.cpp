#include "framework/registry/bind.h"

namespace talus {
namespace {

// A measured point: its coordinates in frame `in`; the point itself is (x, y, z) of frame `at`.
struct Point {
  static Declaration declaration() {
    return feature("point", Kind::point,
                   "measured point: coordinates in frame `in` of the point (x, y, z) of frame `at`")
        .input("x", length, 0, "x of the point in frame `at`")
        .input("y", length, 0, "y of it")
        .input("z", length, 0, "z of it")
        .column(".x", length)
        .column(".y", length)
        .column(".z", length)
        .judged_by({"position"});
  }
  template <class T>
  static Rigid<T> offset(T x, T y, T z) {
    return translate(x, y, z);
  }
  template <class T>
  static Observed<T> observe(T x, T y, T z) {
    return {.kind = Kind::point, .frame = translate(x, y, z)};
  }
};
TALUS_PLUGIN(Point)

}  // namespace
}  // namespace talus
