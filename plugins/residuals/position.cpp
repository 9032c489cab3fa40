#include "framework/registry/bind.h"

namespace talus {
namespace {

// Error of position, measured minus modelled. Of a frame it is the translation of
// E = inverse(T_model) T_measured, so R_model^T (p_measured - p_model), seen from the modelled
// frame (Bonny 2013, eqs 3 and 4); of a point p_measured - p_model, in frame `in`; of a closure
// -p_model.
struct Position {
  static Declaration declaration() {
    return residual("position", {Kind::frame, Kind::point, Kind::nothing},
                    "error of position, three lengths (Bonny 2013, eq. 4)")
        .row("x", length)
        .row("y", length)
        .row("z", length);
  }
  template <class T>
  static std::vector<T> rows(const Rigid<T>& model, const Observed<T>& measured) {
    Vector3<T> error = measured.frame.translation() - model.translation();
    if (measured.kind == Kind::frame) error = seen_from(model.rotation(), error);
    return {error[0], error[1], error[2]};
  }
};
TALUS_PLUGIN(Position)

}  // namespace
}  // namespace talus
