#include "framework/registry/bind.h"

namespace talus {
namespace {

// A plane through probed points; its axis is the normal, about which the points run right-handed
// (the face of a pin: Bonny 2013, sec. 2.2).
struct Plane {
  static Declaration declaration() {
    return shape("plane", 3, 3, Sense::around,
                 "plane through probed points; axis: its normal, about which they run right-handed "
                 "(Bonny 2013, sec. 2.2)");
  }
  template <class T>
  static std::vector<T> deviations(const T&, const T&, const T& z, const T&) {
    return {z};
  }
};
TALUS_PLUGIN(Plane)

}  // namespace
}  // namespace talus
