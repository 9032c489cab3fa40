#include "framework/registry/bind.h"

namespace talus {
namespace {

// Scale or magnet off the shaft's centre by e: the reading errs by e/R once per turn, R the radius
// of the scale. Two read heads opposite each other cancel it.
struct EncoderEccentricity {
  static Declaration declaration() {
    return effect("encoder_eccentricity", Acts::reading,
                  "scale off its centre, once per turn: sine sin(r) + cosine cos(r)")
        .on(angle)
        .amount("sine", angle, 0.1 * deg, "in phase with the reading")
        .amount("cosine", angle, 0.1 * deg, "a quarter turn ahead of it")
        .shown(phasor("amplitude", "phase", "sine", "cosine"))
        .reference("ISO 230-7; eccentricity e on radius R gives e/R");
  }
  template <class T>
  static T act(const Around<T>& around, T sine, T cosine) {
    using std::sin, std::cos;
    return sine * sin(around.reading) + cosine * cos(around.reading);
  }
};
TALUS_PLUGIN(EncoderEccentricity)

// Twice per turn: an oval ring, a tilted magnet or disc, a universal joint at an angle.
struct EncoderSecondHarmonic {
  static Declaration declaration() {
    return effect("encoder_second_harmonic", Acts::reading,
                  "oval or tilted scale, twice per turn: sine sin(2r) + cosine cos(2r)")
        .on(angle)
        .amount("sine", angle, 0.05 * deg, "in phase with twice the reading")
        .amount("cosine", angle, 0.05 * deg, "a quarter period ahead of it")
        .shown(phasor("amplitude", "phase", "sine", "cosine"))
        .reference("universal joint at angle b: amplitude b^2/4");
  }
  template <class T>
  static T act(const Around<T>& around, T sine, T cosine) {
    using std::sin, std::cos;
    return sine * sin(T(2) * around.reading) + cosine * cos(T(2) * around.reading);
  }
};
TALUS_PLUGIN(EncoderSecondHarmonic)

}  // namespace
}  // namespace talus
