#include "framework/registry/bind.h"

namespace talus {
namespace {

std::vector<double> orders(int from, int to, std::vector<double> more = {}) {
  std::vector<double> result;
  for (int n = from; n <= to; ++n) result.push_back(n);
  result.insert(result.end(), more.begin(), more.end());
  return result;
}

// Sub-divisional error: the signal of one scale line is not a perfect sine; the error repeats with
// every line, or several times per line.
struct EncoderInterpolation {
  static Declaration declaration() {
    return effect("encoder_interpolation", Acts::reading,
                  "interpolation within scale lines: sine sin(order r) + cosine cos(order r)")
        .on(angle)
        .amount("sine", angle, 0.02 * deg, "in phase with the signal")
        .amount("cosine", angle, 0.02 * deg, "a quarter period ahead of it")
        .setting("order", number, 8, orders(8, 100, {120, 128, 144, 180, 200, 256, 360, 500, 512}),
                 "periods per turn")
        .shown(phasor("amplitude", "phase", "sine", "cosine"))
        .reference("typically 1 to 2 % of a signal period");
  }
  template <class T>
  static T act(const Around<T>& around, T sine, T cosine, T order) {
    using std::sin, std::cos;
    return sine * sin(order * around.reading) + cosine * cos(order * around.reading);
  }
};
TALUS_PLUGIN(EncoderInterpolation)

// Teeth and stages of a gear between motor and joint: a few periods per turn of the joint.
struct GearTransmissionError {
  static Declaration declaration() {
    return effect("gear_transmission_error", Acts::reading,
                  "gear stages: sine sin(order r) + cosine cos(order r)")
        .on(angle)
        .at_joint()
        .amount("sine", angle, 0.02 * deg, "in phase with the gear")
        .amount("cosine", angle, 0.02 * deg, "a quarter period ahead of it")
        .setting("order", number, 3, orders(3, 7), "periods per turn of the joint")
        .shown(phasor("amplitude", "phase", "sine", "cosine"))
        .reference("Judd and Knasinski 1990");
  }
  template <class T>
  static T act(const Around<T>& around, T sine, T cosine, T order) {
    using std::sin, std::cos;
    return sine * sin(order * around.reading) + cosine * cos(order * around.reading);
  }
};
TALUS_PLUGIN(GearTransmissionError)

}  // namespace
}  // namespace talus
