#include "framework/registry/bind.h"

namespace talus {
namespace {

template <class T>
T positive(const T& x) {
  return select(less(T(0), x), x, T(0));
}

struct MicrometerLeadProgressive {
  static Declaration declaration() {
    return effect("micrometer_lead_progressive", Acts::reading,
                  "lead of the screw wrong from one reading on: scale_error max(r - from, 0)")
        .on(length)
        .amount("scale_error", number, 3e-4, "relative error of the lead")
        .setting_of_reading("from", 0, "reading from which on it is wrong")
        .reference("ISO 3611");
  }
  template <class T>
  static T act(const Around<T>& around, T scale_error, T from) {
    return scale_error * positive(around.reading - from);
  }
};
TALUS_PLUGIN(MicrometerLeadProgressive)

struct MicrometerLeadPeriodic {
  static Declaration declaration() {
    return effect("micrometer_lead_periodic", Acts::reading,
                  "lead error that repeats with every turn of the thimble")
        .on(length)
        .amount("sine", length, 0.003, "in phase with the turn")
        .amount("cosine", length, 0.003, "a quarter turn ahead")
        .setting("pitch", length, 0.5, {}, "travel per turn")
        .shown(phasor("amplitude", "phase", "sine", "cosine"));
  }
  template <class T>
  static T act(const Around<T>& around, T sine, T cosine, T pitch) {
    using std::sin, std::cos;
    const T turn = T(360 * deg) * around.reading / pitch;
    return sine * sin(turn) + cosine * cos(turn);
  }
};
TALUS_PLUGIN(MicrometerLeadPeriodic)

// A spherical tip of radius R on a flat that turns by g against the spindle is further away by
// R (1/cos(g) - 1); g is the change of the angle between the micrometer and the second bar of its
// triangle from that at the reading `neutral`.
struct MicrometerTipOffset {
  static Declaration declaration() {
    return effect("micrometer_tip_offset", Acts::reading,
                  "spherical tip on a tilting flat: tip_radius (1/cos(g) - 1)")
        .on(length)
        .amount("tip_radius", length, 2, "radius of the tip, or what acts as such")
        .setting("neutral", length, 20, {}, "reading at which the flat stands square")
        .of_sensor("bar1", length)
        .of_sensor("bar2", length)
        .of_sensor("madj", length);
  }
  template <class T>
  static T act(const Around<T>& around, T tip_radius, T neutral, T bar1, T bar2, T madj) {
    using std::acos, std::cos;
    auto corner = [&](const T& side) {
      return acos((side * side + bar2 * bar2 - bar1 * bar1) / (T(2) * side * bar2));
    };
    const T g = corner(around.reading + madj) - corner(neutral + madj);
    return tip_radius * (T(1) / cos(g) - T(1));
  }
};
TALUS_PLUGIN(MicrometerTipOffset)

// The micrometer stands askew by psi: it reads too much by psi^2/2 of the travel.
struct CosineError {
  static Declaration declaration() {
    return effect("cosine_error", Acts::reading, "micrometer askew by psi: loss r, loss = psi^2/2")
        .on(length)
        .amount("loss", number, 3e-4, "psi^2/2")
        .same_as("micrometer_lead_progressive")
        .reference("Abbe");
  }
  template <class T>
  static T act(const Around<T>& around, T loss) {
    return loss * around.reading;
  }
};
TALUS_PLUGIN(CosineError)

}  // namespace
}  // namespace talus
