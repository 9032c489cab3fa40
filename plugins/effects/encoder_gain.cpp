#include "framework/registry/bind.h"

namespace talus {
namespace {

// Wrong counts per turn, a potentiometer's supply. Where the model has a free slope this is the
// same number, and calibration has found it.
struct EncoderGain {
  static Declaration declaration() {
    return effect("encoder_gain", Acts::reading, "gain of a sensor that has no slope: gain r")
        .on(angle)
        .amount("gain", number, 1e-3, "relative error of the reading");
  }
  template <class T>
  static T act(const Around<T>& around, T gain) {
    return gain * around.reading;
  }
};
TALUS_PLUGIN(EncoderGain)

// A scale that slips on its shaft, a missed index, lost counts.
struct EncoderZeroSlip {
  static Declaration declaration() {
    return effect("encoder_zero_slip", Acts::reading, "the zero jumps by `step` from one pose on")
        .on(angle)
        .amount("step", angle, 0.1 * deg, "added to the reading from that pose on")
        .onset("pose", Covariate::pose, "number of the first pose that is read so");
  }
  template <class T>
  static T act(const Around<T>& around, T step, T pose) {
    return select(less(around.pose, pose), T(0), step);
  }
};
TALUS_PLUGIN(EncoderZeroSlip)

}  // namespace
}  // namespace talus
