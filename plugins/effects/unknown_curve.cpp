// What no formula here describes: a smooth curve, a cubic B-spline on equal pieces between `from`
// and `to`, level beyond them.
#include "framework/registry/bind.h"

namespace talus {
namespace {

// Forms of 6 pieces, 24, and 48 where a reading errs many times per turn.
Declaration curve(Declaration d, Dimension unit, bool of_reading, double small_angle,
                  double small_length, int most = 24) {
  for (int i = 1; i <= most + 3; ++i) {
    const std::string name = "c" + std::to_string(i),
                      meaning = "height of the curve's piece " + std::to_string(i);
    if (of_reading)
      d.amount_of_reading(name, number, small_angle, small_length, meaning);
    else
      d.amount(name, unit, unit == length ? small_length : small_angle, meaning);
  }
  for (int pieces = 6; pieces <= most; pieces = pieces < 24 ? 24 : 2 * pieces) {
    std::vector<std::string> amounts;
    for (int i = 1; i <= pieces + 3; ++i) amounts.push_back("c" + std::to_string(i));
    if (pieces <= 24)
      d.form(amounts);
    else
      d.finer_form(amounts);
  }
  return d.unknown();
}

// inputs: heights, then from, to. As many pieces as heights that are not the plain number zero.
template <class T>
T height(const T& at, const std::vector<T>& inputs) {
  const auto most = static_cast<int>(inputs.size()) - 3;
  const T &from = inputs[most], &to = inputs[most + 1], &pieces = inputs[most + 2];
  auto positive = [](const T& x) { return select(less(T(0), x), x, T(0)); };
  const T u = pieces * (at - from) / (to - from),
          inside = select(less(u, T(0)), T(0), select(less(pieces, u), pieces, u));
  T sum(0);
  for (int i = 0; i < most; ++i) {
    using std::abs;
    const T d = abs(inside - T(i - 1)), two = positive(T(2) - d), one = positive(T(1) - d);
    sum = sum + inputs[i] * (two * two * two - T(4) * one * one * one) / T(6);
  }
  return sum;
}

struct UnknownReadingCurve {
  static Declaration declaration() {
    return curve(effect("unknown_reading", Acts::reading,
                        "error of a reading as a smooth curve of the reading itself"),
                 number, true, 0.05 * deg, 0.01, 48)
        .setting_of_reading("from", 0, "reading at which the curve begins")
        .setting_of_reading("to", 1, "reading at which it ends")
        .setting("pieces", number, 6, {}, "pieces between them");
  }
  template <class T>
  static T act_on_list(const Around<T>& around, const std::vector<T>& inputs,
                       const std::vector<int>&) {
    return height(around.reading, inputs);
  }
};
TALUS_PLUGIN(UnknownReadingCurve)

struct UnknownReadingDrift {
  static Declaration declaration() {
    return curve(effect("unknown_drift", Acts::reading,
                        "error of a reading as a smooth curve of the time"),
                 number, true, 0.05 * deg, 0.01)
        .setting("from", duration, 0, {}, "time at which the curve begins")
        .setting("to", duration, 1, {}, "time at which it ends")
        .setting("pieces", number, 6, {}, "pieces between them")
        .needs(Covariate::time);
  }
  template <class T>
  static T act_on_list(const Around<T>& around, const std::vector<T>& inputs,
                       const std::vector<int>&) {
    return height(around.time, inputs);
  }
};
TALUS_PLUGIN(UnknownReadingDrift)

// Along or about an axis of the joint's axis frame, as a curve of the joint's own coordinate.
template <bool turns>
struct UnknownMotion {
  static Declaration declaration() {
    const std::string moves = turns ? "turns about" : "shifts along";
    return curve(
               effect(turns ? "unknown_tilt" : "unknown_shift", Acts::axis,
                      "axis " + moves + " `direction` as a smooth curve of the joint's coordinate"),
               turns ? angle : length, false, 0.05 * deg, 0.05)
        .setting("from", angle, 0, {}, "coordinate at which the curve begins")
        .setting("to", angle, 1, {}, "coordinate at which it ends")
        .setting("pieces", number, 6, {}, "pieces between them")
        .on(angle)
        .choice(
            "direction",
            turns ? std::vector<std::string>{"x", "y"} : std::vector<std::string>{"x", "y", "z"},
            "axis of the joint's axis frame");
  }
  template <class T>
  static Twist<T> act_on_list(const Around<T>& around, const std::vector<T>& inputs,
                              const std::vector<int>& choices) {
    Twist<T> twist;
    for (auto* v : {&twist.translation, &twist.rotation})
      for (T& t : *v) t = T(0);
    (turns ? twist.rotation : twist.translation)[choices[0]] = height(around.coordinate, inputs);
    return twist;
  }
};
using UnknownShift = UnknownMotion<false>;
using UnknownTilt = UnknownMotion<true>;
TALUS_PLUGIN(UnknownShift)
TALUS_PLUGIN(UnknownTilt)

}  // namespace
}  // namespace talus
