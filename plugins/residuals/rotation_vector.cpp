#include "framework/registry/bind.h"

namespace talus {
namespace {

// Error of orientation as a rotation vector (axis times angle): log(R_model^T R_measured). It has
// no preferred axis and no singular place below half a turn (Murray, Li and Sastry 1994, ch. 2).
struct RotationVector {
  static Declaration declaration() {
    return residual("rotation_vector", {Kind::frame, Kind::nothing},
                    "error of orientation as a rotation vector: log(R_model^T R_measured) (Murray, "
                    "Li and Sastry 1994, ch. 2)")
        .row("rx", angle)
        .row("ry", angle)
        .row("rz", angle);
  }
  template <class T>
  static std::vector<T> rows(const Rigid<T>& model, const Observed<T>& measured) {
    const Vector3<T> error =
        rotation_vector(seen_from(model.rotation(), measured.frame.rotation()));
    return {error[0], error[1], error[2]};
  }
};
TALUS_PLUGIN(RotationVector)

}  // namespace
}  // namespace talus
