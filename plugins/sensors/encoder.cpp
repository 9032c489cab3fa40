#include "framework/registry/bind.h"

namespace talus {
namespace {

// Rotary encoder: angle = slope * reading + intercept.
struct Encoder {
  static Declaration declaration() {
    return sensor("encoder", angle, angle,
                  "rotary encoder: slope * reading + intercept (Bonny 2013, sec. 2.1)")
        .input("slope", number, 1, "angle per reading")
        .input("intercept", angle, 0, "angle at reading zero");
  }
  template <class T>
  static T value(T reading, T slope, T intercept) {
    return slope * reading + intercept;
  }
};
TALUS_PLUGIN(Encoder)

}  // namespace
}  // namespace talus
