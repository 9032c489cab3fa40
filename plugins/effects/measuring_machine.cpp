// A measuring machine whose scales or axes are not right: measured coordinates are (1 + D) p.
#include "framework/registry/bind.h"

namespace talus {
namespace {

template <class T>
Matrix3<T> scales(const T& x, const T& y, const T& z) {
  return {{{x, T(0), T(0)}, {T(0), y, T(0)}, {T(0), T(0), z}}};
}

struct MeasurementScale {
  static Declaration declaration() {
    return effect("measurement_scale", Acts::measured,
                  "measured coordinates too large by scale_error: all, or along one axis")
        .amount("scale_error", number, 1e-4, "of all axes")
        .amount("x", number, 1e-4, "of the x axis alone")
        .amount("y", number, 1e-4, "of the y axis alone")
        .amount("z", number, 1e-4, "of the z axis alone")
        .form({"scale_error"})
        .form({"x"})
        .form({"y"})
        .form({"z"})
        .shown(renamed("x", "scale_error"))
        .shown(renamed("y", "scale_error"))
        .shown(renamed("z", "scale_error"))
        .reference("ISO 10360");
  }
  template <class T>
  static Matrix3<T> act(const Around<T>&, T scale_error, T x, T y, T z) {
    return scales<T>(scale_error + x, scale_error + y, scale_error + z);
  }
};
TALUS_PLUGIN(MeasurementScale)

struct MeasurementSquareness {
  static Declaration declaration() {
    return effect("measurement_squareness", Acts::measured,
                  "axes of the machine not square: x gains sin(xy) y, and so on")
        .amount("xy", angle, 0.01 * deg, "x gains of y")
        .amount("xz", angle, 0.01 * deg, "x gains of z")
        .amount("yz", angle, 0.01 * deg, "y gains of z")
        .form({"xy"})
        .form({"xz"})
        .form({"yz"})
        .shown(renamed("xy", "angle"))
        .shown(renamed("xz", "angle"))
        .shown(renamed("yz", "angle"))
        .reference("ISO 10360; Zhang 1985");
  }
  template <class T>
  static Matrix3<T> act(const Around<T>&, T xy, T xz, T yz) {
    using std::sin;
    return {{{T(0), sin(xy), sin(xz)}, {T(0), T(0), sin(yz)}, {T(0), T(0), T(0)}}};
  }
};
TALUS_PLUGIN(MeasurementSquareness)

// The stylus' radius was taken wrongly: distances err by a constant.
struct ProbeRadius {
  static Declaration declaration() {
    return effect("probe_radius", Acts::measured,
                  "distances from the origin too long by a constant: radius error of the probe")
        .on(length)
        .amount("radius", length, 0.003, "error of the radius")
        .reference("ISO 10360-5");
  }
  template <class T>
  static Matrix3<T> act(const Around<T>& around, T radius) {
    const T s = radius / (norm(around.position) + T(1e-9));
    return scales<T>(s, s, s);
  }
};
TALUS_PLUGIN(ProbeRadius)

// A wire of weight w per length under tension H sags: its length errs by w^2 L^3 / (24 H^2).
struct WireSag {
  static Declaration declaration() {
    return effect("wire_sag", Acts::measured, "draw wire sags: length L grows by sag L^3")
        .on(length)
        .amount("sag", number / (length * length), 1e-10, "w^2 / (24 H^2)");
  }
  template <class T>
  static Matrix3<T> act(const Around<T>& around, T sag) {
    const T s = sag * dot(around.position, around.position);
    return scales<T>(s, s, s);
  }
};
TALUS_PLUGIN(WireSag)

}  // namespace
}  // namespace talus
