#include "framework/registry/bind.h"

namespace talus {
namespace {

// Errors that repeat `order` times per turn: sine sin(order r) + cosine cos(order r).
template <class T>
T wave(const T& r, const T& sine, const T& cosine, const T& order) {
  using std::sin, std::cos;
  return sine * sin(order * r) + cosine * cos(order * r);
}

Declaration waves(const char* name, const char* summary, double typical, const std::string& with,
                  const std::string& quarter) {
  return effect(name, Acts::reading, summary)
      .on(angle)
      .amount("sine", angle, typical, "in phase with " + with)
      .amount("cosine", angle, typical, "a quarter " + quarter)
      .shown(phasor("amplitude", "phase", "sine", "cosine"));
}

std::vector<double> orders(int from, int to, std::vector<double> more = {}) {
  std::vector<double> result;
  for (int n = from; n <= to; ++n) result.push_back(n);
  result.insert(result.end(), more.begin(), more.end());
  return result;
}

// Scale or magnet off the shaft's centre by e: the reading errs by e/R once per turn, R the radius
// of the scale. Two read heads opposite each other cancel it.
struct EncoderEccentricity {
  static Declaration declaration() {
    return waves("encoder_eccentricity",
                 "scale off its centre, once per turn: sine sin(r) + cosine cos(r)", 0.1 * deg,
                 "the reading", "turn ahead of it")
        .reference("ISO 230-7; eccentricity e on radius R gives e/R");
  }
  template <class T>
  static T act(const Around<T>& around, T sine, T cosine) {
    return wave(around.reading, sine, cosine, T(1));
  }
};
TALUS_PLUGIN(EncoderEccentricity)

// Twice per turn: an oval ring, a tilted magnet or disc, a universal joint at an angle.
struct EncoderSecondHarmonic {
  static Declaration declaration() {
    return waves("encoder_second_harmonic",
                 "oval or tilted scale, twice per turn: sine sin(2r) + cosine cos(2r)", 0.05 * deg,
                 "twice the reading", "period ahead of it")
        .reference("universal joint at angle b: amplitude b^2/4");
  }
  template <class T>
  static T act(const Around<T>& around, T sine, T cosine) {
    return wave(around.reading, sine, cosine, T(2));
  }
};
TALUS_PLUGIN(EncoderSecondHarmonic)

// Sub-divisional error: the signal of one scale line is not a perfect sine; the error repeats with
// every line, or several times per line.
struct EncoderInterpolation {
  static Declaration declaration() {
    return waves("encoder_interpolation",
                 "interpolation within scale lines: sine sin(order r) + cosine cos(order r)",
                 0.02 * deg, "the signal", "period ahead of it")
        .setting("order", number, 8, orders(8, 100, {120, 128, 144, 180, 200, 256, 360, 500, 512}),
                 "periods per turn")
        .reference("typically 1 to 2 % of a signal period");
  }
  template <class T>
  static T act(const Around<T>& around, T sine, T cosine, T order) {
    return wave(around.reading, sine, cosine, order);
  }
};
TALUS_PLUGIN(EncoderInterpolation)

// Teeth and stages of a gear between motor and joint: a few periods per turn of the joint.
struct GearTransmissionError {
  static Declaration declaration() {
    return waves("gear_transmission_error", "gear stages: sine sin(order r) + cosine cos(order r)",
                 0.02 * deg, "the gear", "period ahead of it")
        .at_joint()
        .setting("order", number, 3, orders(3, 7), "periods per turn of the joint")
        .reference("Judd and Knasinski 1990");
  }
  template <class T>
  static T act(const Around<T>& around, T sine, T cosine, T order) {
    return wave(around.reading, sine, cosine, order);
  }
};
TALUS_PLUGIN(GearTransmissionError)

}  // namespace
}  // namespace talus
