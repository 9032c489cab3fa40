#include "framework/registry/bind.h"

namespace talus {
namespace {

// Readings and measurement are not taken at the same moment.
struct TimeLag {
  static Declaration declaration() {
    return effect("time_lag", Acts::reading,
                  "readings lag behind the measurement: lag times each reading's rate")
        .amount("lag", duration, 0.005, "time by which the readings must be moved on")
        .needs(Covariate::rate)
        .everywhere();
  }
  template <class T>
  static T act(const Around<T>& around, T lag) {
    return lag * around.rate;
  }
};
TALUS_PLUGIN(TimeLag)

}  // namespace
}  // namespace talus
