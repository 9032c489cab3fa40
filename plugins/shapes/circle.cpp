#include "framework/registry/bind.h"

namespace talus {
namespace {

// A circle through probed points; its axis is the normal of its plane, about which the points run
// right-handed. With `on` the points are projected on a plane first (Bonny 2013, sec. 2.2).
struct Circle {
  static Declaration declaration() {
    return shape("circle", 6, 3, Sense::around,
                 "circle through probed points, projected on a plane first with `on` (Bonny 2013, "
                 "sec. 2.2)");
  }
  template <class T>
  static std::vector<T> deviations(const T& x, const T& y, const T& z, const T& radius) {
    return {norm<T>({x, y, T(0)}) - radius, z};
  }
};
TALUS_PLUGIN(Circle)

}  // namespace
}  // namespace talus
