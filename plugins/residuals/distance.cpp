#include "framework/registry/bind.h"

namespace talus {
namespace {

// Error of the distance between the origins of frames `at` and `in`, measured minus modelled. A
// closure measures nothing: there the distance is known, `nominal` (a ball bar's length in
// telescoping ball-bar calibration: Hollerbach and Wampler 1996).
struct Distance {
  static Declaration declaration() {
    return residual("distance", {Kind::frame, Kind::point, Kind::scalar, Kind::nothing},
                    "error of a distance, as of a ball bar; for a closure against the nominal "
                    "distance (Hollerbach and Wampler 1996)")
        .input("nominal", length, 0, "the known distance, used for closures only")
        .row("distance", length);
  }
  template <class T>
  static std::vector<T> rows(const Rigid<T>& model, const Observed<T>& measured, T nominal) {
    const T seen = measured.kind == Kind::nothing  ? nominal
                   : measured.kind == Kind::scalar ? measured.scalar
                                                   : norm(measured.frame.translation());
    return {seen - norm(model.translation())};
  }
};
TALUS_PLUGIN(Distance)

}  // namespace
}  // namespace talus
