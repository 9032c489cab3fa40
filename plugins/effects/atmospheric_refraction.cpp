#include "framework/registry/bind.h"

namespace talus {
namespace {

// The air bends a line of sight, so that what is looked at stands too high; what a correction for
// it has left grows the same way, with the cotangent of the elevation.
struct AtmosphericRefraction {
  static Declaration declaration() {
    return effect(
               "atmospheric_refraction", Acts::measured,
               "line of sight lifted by the air: coefficient times the cotangent of the elevation")
        .on(number)
        .amount("coefficient", angle, 2.0 / 3600 * deg, "lift at an elevation of 45 deg")
        .choice("up", {"z", "y", "x"}, "axis of the measuring frame that points upwards")
        .reference("standard air at sea level: 58 arcsec");
  }
  // A direction e is lifted by c cot(elevation) where its upward part u grows by c / u.
  template <class T>
  static Matrix3<T> act(const Around<T>& around, T coefficient, int up) {
    const T u = around.position[2 - up];
    Matrix3<T> D{};
    for (auto& row : D)
      for (T& d : row) d = T(0);
    D[2 - up][2 - up] = coefficient / (u * u + T(1e-6));
    return D;
  }
};
TALUS_PLUGIN(AtmosphericRefraction)

}  // namespace
}  // namespace talus
