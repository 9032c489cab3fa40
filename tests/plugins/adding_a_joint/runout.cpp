#include "framework/registry/bind.h"

namespace talus {

// Revolute joint with axial run-out: turning by theta also moves it along its axis, as a face cam
// of amplitude `runout` does. T_A_B = Tz(runout cos(theta - phase)) Rz(theta)
struct Runout {
  static Declaration declaration() {
    return joint("runout",
                 "revolute joint with axial run-out: Tz(runout cos(theta - phase)) Rz(theta)")
        .coordinate("theta", angle, "rotation about z of A")
        .input("runout", length, 0, "amplitude along z")
        .input("phase", angle, 0, "theta where the run-out is largest");
  }
  template <class T>
  static Rigid<T> transform(T theta, T runout, T phase) {
    return translate_z(runout * cos(theta - phase)) * rotate_z(theta);
  }
};
TALUS_PLUGIN(Runout)

}  // namespace talus
