#include "framework/registry/bind.h"

namespace talus {
namespace {

// A sphere through probed points; what counts is its centre (proposed for both ends of the
// calibration device: Nordquist 2009, sec. 4).
struct Sphere {
  static Declaration declaration() {
    return shape("sphere", 4, 4, Sense::none,
                 "sphere through probed points: its centre (Nordquist 2009, sec. 4)");
  }
  template <class T>
  static std::vector<T> deviations(const T& x, const T& y, const T& z, const T& radius) {
    return {norm<T>({x, y, z}) - radius};
  }
};
TALUS_PLUGIN(Sphere)

}  // namespace
}  // namespace talus
