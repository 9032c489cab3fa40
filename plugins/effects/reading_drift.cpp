#include "framework/registry/bind.h"

namespace talus {
namespace {

// Drift of one reading with the time or with the temperature: electronics, or the mount of the
// scale warming up.
struct ThermalDrift {
  static Declaration declaration() {
    return effect("thermal_drift", Acts::reading, "reading drifts: rate t, or per_degree (T - 20)")
        .amount_of_reading("rate", number / duration, 0.02 * deg / 3600, 0.002 / 3600,
                           "drift per time")
        .amount_of_reading("per_degree", number / temperature, 0.01 * deg, 0.001,
                           "drift per degree of the recorded temperature")
        .needs(Covariate::time)
        .needs(Covariate::temperature)
        .form({"rate"})
        .form({"per_degree"})
        .shown(renamed("rate", "rate", "deg/h|mm/h"));
  }
  template <class T>
  static T act(const Around<T>& around, T rate, T per_degree) {
    return rate * around.time + per_degree * (around.temperature - T(20));
  }
};
TALUS_PLUGIN(ThermalDrift)

struct ReadingDrift {
  static Declaration declaration() {
    return effect("reading_drift", Acts::reading, "reading drifts with the time: rate t")
        .amount_of_reading("rate", number / duration, 0.02 * deg / 3600, 0.002 / 3600,
                           "drift per time")
        .needs(Covariate::time)
        .shown(renamed("rate", "rate", "deg/h|mm/h"))
        .same_as("thermal_drift");
  }
  template <class T>
  static T act(const Around<T>& around, T rate) {
    return rate * around.time;
  }
};
TALUS_PLUGIN(ReadingDrift)

}  // namespace
}  // namespace talus
