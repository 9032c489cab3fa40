#include "framework/registry/bind.h"

namespace talus {
namespace {

// Play between the joint and its sensor (or in a micrometer's nut): the reading leads or lags by
// half the play, according to the sense in which the joint was last moved; or according to the
// side on which the load holds it.
struct Backlash {
  static Declaration declaration() {
    return effect("backlash", Acts::reading,
                  "play: half_width times the sense of approach, or times the load's sign")
        .at_joint()
        .amount_of_reading("half_width", number, 0.03 * deg, 0.005, "half the play, by approach")
        .amount_of_reading("half_width_load", number, 0.03 * deg, 0.005,
                           "half the play, by the sign of the joint's moment under gravity")
        .needs(Covariate::approach)
        .needs(Covariate::load)
        .form({"half_width"})
        .form({"half_width_load"})
        .shown(renamed("half_width_load", "half_width"));
  }
  template <class T>
  static T act(const Around<T>& around, T half_width, T half_width_load) {
    return half_width * around.approach + half_width_load * sign(around.moment[2]);
  }
};
TALUS_PLUGIN(Backlash)

struct MicrometerBacklash {
  static Declaration declaration() {
    return effect("micrometer_backlash", Acts::reading,
                  "play in a micrometer's nut: half_width times the sense of approach")
        .on(length)
        .amount("half_width", length, 0.005, "half the play")
        .needs(Covariate::approach)
        .same_as("backlash");
  }
  template <class T>
  static T act(const Around<T>& around, T half_width) {
    return half_width * around.approach;
  }
};
TALUS_PLUGIN(MicrometerBacklash)

// Friction and wind-up: the loop closes gradually after a reversal, over a travel of some `reach`
// (play operator, smoothed).
struct Hysteresis {
  static Declaration declaration() {
    return effect(
               "hysteresis", Acts::reading,
               "loop that closes after a reversal: half_width approach (1 - 2 exp(-travel/reach))")
        .on(angle)
        .at_joint()
        .amount("half_width", angle, 0.03 * deg, "half the loop's width")
        .setting("reach", angle, 5 * deg, {4 * deg, 12 * deg, 30 * deg},
                 "travel over which the loop closes")
        .needs(Covariate::approach)
        .needs(Covariate::travel);
  }
  template <class T>
  static T act(const Around<T>& around, T half_width, T reach) {
    using std::exp;
    return half_width * around.approach * (T(1) - T(2) * exp(-around.travel / reach));
  }
};
TALUS_PLUGIN(Hysteresis)

}  // namespace
}  // namespace talus
