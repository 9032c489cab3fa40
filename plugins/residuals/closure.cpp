#include "framework/registry/bind.h"

namespace talus {
namespace {

// What is left open of a loop that should close: -p_model in frame `in`, and the rotation vector
// log(R_model^T) (closed-loop calibration, Hollerbach and Wampler 1996).
struct Closure {
  static Declaration declaration() {
    return residual("closure", {Kind::nothing},
                    "gap of a loop that should close, three lengths and a rotation vector "
                    "(Hollerbach and Wampler 1996)")
        .row("x", length)
        .row("y", length)
        .row("z", length)
        .row("rx", angle)
        .row("ry", angle)
        .row("rz", angle);
  }
  template <class T>
  static std::vector<T> rows(const Rigid<T>& model, const Observed<T>&) {
    const Vector3<T> p = model.translation(), r = rotation_vector(model.rotation());
    return {-p[0], -p[1], -p[2], -r[0], -r[1], -r[2]};  // log(R^T) = -log(R)
  }
};
TALUS_PLUGIN(Closure)

}  // namespace
}  // namespace talus
