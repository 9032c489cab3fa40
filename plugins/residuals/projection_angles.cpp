#include "framework/registry/bind.h"

namespace talus {
namespace {

// Error of orientation as projection angles of E = R_model^T R_measured (Bonny 2013, eqs 5-7, there
// with atan; atan2 holds beyond 90 deg): atan2(E32, E22), atan2(E13, E33), atan2(E21, E11).
struct ProjectionAngles {
  static Declaration declaration() {
    return residual("projection_angles", {Kind::frame, Kind::nothing},
                    "error of orientation as three projection angles (Bonny 2013, eqs 5-7)")
        .row("PAx", angle)
        .row("PAy", angle)
        .row("PAz", angle);
  }
  template <class T>
  static std::vector<T> rows(const Rigid<T>& model, const Observed<T>& measured) {
    using std::atan2;
    const Matrix3<T> E = seen_from(model.rotation(), measured.frame.rotation());
    return {atan2(E[2][1], E[1][1]), atan2(E[0][2], E[2][2]), atan2(E[1][0], E[0][0])};
  }
};
TALUS_PLUGIN(ProjectionAngles)

}  // namespace
}  // namespace talus
