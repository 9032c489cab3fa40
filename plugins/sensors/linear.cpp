#include "framework/registry/bind.h"

namespace talus {
namespace {

// Linear transducer: length = slope * reading + intercept (the linear form of Bonny 2013,
// sec. 2.1).
struct Linear {
  static Declaration declaration() {
    return sensor("linear", length, length,
                  "linear transducer: slope * reading + intercept (Bonny 2013, sec. 2.1)")
        .input("slope", number, 1, "length per reading")
        .input("intercept", length, 0, "length at reading zero");
  }
  template <class T>
  static T value(T reading, T slope, T intercept) {
    return slope * reading + intercept;
  }
};
TALUS_PLUGIN(Linear)

}  // namespace
}  // namespace talus
