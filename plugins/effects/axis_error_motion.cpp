// Error motions of an axis of rotation (ISO 230-7), in the axis frame before the joint turns.
#include "framework/registry/bind.h"

namespace talus {
namespace {

template <class T>
std::array<T, 2> to_and_fro(const Around<T>& around, T x_sine, T x_cosine, T y_sine, T y_cosine,
                            T round_sine, T round_cosine, T order) {
  using std::sin, std::cos;
  const T s = sin(order * around.coordinate), c = cos(order * around.coordinate);
  return {x_sine * s + x_cosine * c + round_cosine * c - round_sine * s,
          y_sine * s + y_cosine * c + round_cosine * s + round_sine * c};
}

Declaration error_motion(const char* tag, const char* summary, Dimension d, double typical) {
  return effect(tag, Acts::axis, summary)
      .on(angle)
      .amount("x_sine", d, typical, "along x, in phase with order times the angle")
      .amount("x_cosine", d, typical, "along x, a quarter period ahead")
      .amount("y_sine", d, typical, "along y, in phase")
      .amount("y_cosine", d, typical, "along y, a quarter period ahead")
      .amount("round_sine", d, typical, "going round with the angle: part ahead")
      .amount("round_cosine", d, typical, "going round with the angle: part in phase")
      .setting("order", number, 1, {1, 2, 3}, "periods per turn")
      .form({"x_sine", "x_cosine", "y_sine", "y_cosine"})
      .form({"round_sine", "round_cosine"})
      .shown(ellipse({"x_sine", "x_cosine", "y_sine", "y_cosine"}))
      .shown(phasor("amplitude", "phase", "round_cosine", "round_sine"))
      .reference("ISO 230-7");
}

struct AxisRadialRunout {
  static Declaration declaration() {
    return error_motion("axis_radial_runout",
                        "axis shifts sideways with the angle, order times per turn", length, 0.02);
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T xs, T xc, T ys, T yc, T rs, T rc, T order) {
    const auto [x, y] = to_and_fro(around, xs, xc, ys, yc, rs, rc, order);
    return {{x, y, T(0)}, {}};
  }
};
TALUS_PLUGIN(AxisRadialRunout)

struct AxisTiltWobble {
  static Declaration declaration() {
    return error_motion("axis_tilt_wobble", "axis tilts with the angle, order times per turn",
                        angle, 0.05 * deg);
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T xs, T xc, T ys, T yc, T rs, T rc, T order) {
    const auto [x, y] = to_and_fro(around, xs, xc, ys, yc, rs, rc, order);
    return {{}, {x, y, T(0)}};
  }
};
TALUS_PLUGIN(AxisTiltWobble)

struct AxisAxialRunout {
  static Declaration declaration() {
    return effect("axis_axial_runout", Acts::axis,
                  "axis shifts along itself with the angle, order times per turn")
        .on(angle)
        .amount("sine", length, 0.02, "in phase with order times the angle")
        .amount("cosine", length, 0.02, "a quarter period ahead")
        .setting("order", number, 1, {1, 2}, "periods per turn")
        .shown(phasor("amplitude", "phase", "sine", "cosine"))
        .reference("ISO 230-7");
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T sine, T cosine, T order) {
    using std::sin, std::cos;
    return {{T(0), T(0),
             sine * sin(order * around.coordinate) + cosine * cos(order * around.coordinate)},
            {}};
  }
};
TALUS_PLUGIN(AxisAxialRunout)

}  // namespace
}  // namespace talus
