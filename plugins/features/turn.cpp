#include "framework/registry/bind.h"

namespace talus {
namespace {

// A measured angle: how far the frame `at` is turned about the z axis of the frame `in`, as an
// encoder or a resolver beside a drive's counter tells it.
struct Turn {
  static Declaration declaration() {
    return feature("turn", Kind::frame, "measured angle of frame `at` about z of frame `in`")
        .column("", angle)
        .judged_by({"turn"});
  }
  template <class T>
  static Observed<T> observe(T value) {
    return {.kind = Kind::frame, .frame = Rigid<T>(rotate_z(value))};
  }
};
TALUS_PLUGIN(Turn)

}  // namespace
}  // namespace talus
