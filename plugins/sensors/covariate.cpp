#include "framework/registry/bind.h"

namespace talus {
namespace {

// A recorded number as it stands (a payload, a setting): value = reading, for use in expressions.
struct Covariate {
  static Declaration declaration() {
    return sensor("covariate", number, number,
                  "recorded number, used as it stands: value = reading");
  }
  template <class T>
  static T value(T reading) {
    return reading;
  }
};
TALUS_PLUGIN(Covariate)

}  // namespace
}  // namespace talus
