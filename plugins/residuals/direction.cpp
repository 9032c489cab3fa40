#include "framework/registry/bind.h"

namespace talus {
namespace {

// Error of a direction as two angles about the modelled one: with e = R_model^T d_measured, e = z
// where they agree, atan2(e_x, e_z) and atan2(e_y, e_z) (projection angles as in Bonny 2013, eqs
// 5-7).
struct Direction {
  static Declaration declaration() {
    return residual("direction", {Kind::direction},
                    "error of a direction, two angles across the modelled one (projection angles, "
                    "after Bonny 2013, eqs 5-7)")
        .row("dx", angle)
        .row("dy", angle);
  }
  template <class T>
  static std::vector<T> rows(const Rigid<T>& model, const Observed<T>& measured) {
    using std::atan2, std::cos;
    Vector3<T> d = measured.vector;
    if (measured.angles) d = {cos(d[0]), cos(d[1]), cos(d[2])};
    const Vector3<T> e = seen_from(model.rotation(), d);
    return {atan2(e[0], e[2]), atan2(e[1], e[2])};
  }
};
TALUS_PLUGIN(Direction)

}  // namespace
}  // namespace talus
