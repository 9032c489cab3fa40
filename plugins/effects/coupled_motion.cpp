#include "framework/registry/bind.h"

namespace talus {
namespace {

// Belts, tendons, gears of a wrist: a joint turns with another one. Joints of the body: the bone
// slides along the axis as it turns.
struct CoupledMotion {
  static Declaration declaration() {
    return effect(
               "coupled_motion", Acts::axis,
               "joint turns by ratio, or slides along its axis by lead, times another coordinate")
        .amount("ratio", number, 1e-3, "turn about the joint's own axis")
        .amount("lead", length / angle, 3 / (30 * deg), "slide along the joint's own axis")
        .driven_by(Driven::by_other, "the joint or unknown whose coordinate drives it")
        .form({"ratio"}, Driven::by_other)
        .form({"lead"}, Driven::by_any)
        .shown(renamed("lead", "ratio"));
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T ratio, T lead) {
    return {{T(0), T(0), lead * around.driver}, {T(0), T(0), ratio * around.driver}};
  }
};
TALUS_PLUGIN(CoupledMotion)

}  // namespace
}  // namespace talus
