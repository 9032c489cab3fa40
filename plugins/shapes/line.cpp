#include "framework/registry/bind.h"

namespace talus {
namespace {

// A line through probed points; its axis runs from the first to the last of them (the side of a
// link: Bonny 2013, sec. 2.2).
struct Line {
  static Declaration declaration() {
    return shape(
        "line", 4, 2, Sense::along,
        "line through probed points; axis: from the first to the last (Bonny 2013, sec. 2.2)");
  }
  template <class T>
  static std::vector<T> deviations(const T& x, const T& y, const T&, const T&) {
    return {x, y};
  }
};
TALUS_PLUGIN(Line)

}  // namespace
}  // namespace talus
