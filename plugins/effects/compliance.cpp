// What gives way in and at a joint under its static load.
#include "framework/registry/bind.h"

namespace talus {
namespace {

// Gear, belt, motor or coupling as a torsion spring. In a linkage held at both ends the free axes
// carry no moment, and this does nothing there.
struct JointCompliance {
  static Declaration declaration() {
    return effect("joint_compliance", Acts::coordinate,
                  "torsion spring about the joint's axis: compliance times its static moment")
        .on(angle)
        .amount("compliance", angle / torque, 1 * deg / 1e6, "angle per moment")
        .not_negative()
        .usual_size(0, 0.03 * deg)
        .shown(renamed("compliance", "compliance", "deg/(N*m)"))
        .needs(Covariate::load)
        .reference("Nubiola and Bonev 2013; Klimchik and Pashkevich 2014");
  }
  template <class T>
  static T act(const Around<T>& around, T compliance) {
    return compliance * around.moment[2];
  }
};
TALUS_PLUGIN(JointCompliance)

// Bearings that tilt under the moment across the axis.
struct BearingTiltCompliance {
  static Declaration declaration() {
    return effect("bearing_tilt_compliance", Acts::axis,
                  "bearings tilt: compliance times the static moment across the axis")
        .amount("compliance", angle / torque, 1 * deg / 1e6, "angle per moment")
        .not_negative()
        .usual_size(0, 0.03 * deg)
        .shown(renamed("compliance", "compliance", "deg/(N*m)"))
        .needs(Covariate::load);
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T compliance) {
    return {{}, {compliance * around.moment[0], compliance * around.moment[1], T(0)}};
  }
};
TALUS_PLUGIN(BearingTiltCompliance)

// A loose bearing lies on the side to which its load pushes it.
struct ClearanceShift {
  static Declaration declaration() {
    return effect("clearance_shift", Acts::axis,
                  "loose bearing: shifts across the axis by clearance, the way its load points")
        .amount("clearance", length, 0.03, "radial clearance")
        .not_negative()
        .needs(Covariate::load);
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T clearance) {
    const T fx = around.force[0], fy = around.force[1];
    const T size = safe_sqrt(fx * fx + fy * fy) + T(1e-9);
    return {{clearance * fx / size, clearance * fy / size, T(0)}, {}};
  }
};
TALUS_PLUGIN(ClearanceShift)

}  // namespace
}  // namespace talus
