#include "framework/registry/bind.h"

namespace talus {
namespace {

// A cylinder through probed points; its axis runs from the first towards the last of them (the ends
// of the calibration device: Nordquist 2009, sec. 2.2).
struct Cylinder {
  static Declaration declaration() {
    return shape("cylinder", 5, 5, Sense::along,
                 "cylinder through probed points; axis: from the first towards the last (Nordquist "
                 "2009, sec. 2.2)");
  }
  template <class T>
  static std::vector<T> deviations(const T& x, const T& y, const T&, const T& radius) {
    return {norm<T>({x, y, T(0)}) - radius};
  }
};
TALUS_PLUGIN(Cylinder)

}  // namespace
}  // namespace talus
