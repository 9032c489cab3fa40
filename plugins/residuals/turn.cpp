#include "framework/registry/bind.h"

namespace talus {
namespace {

// Error of the turn about z alone: of the rotation vector log(R_model^T R_measured) its last part.
struct Turn {
  static Declaration declaration() {
    return residual("turn", {Kind::frame}, "error of the turn about z, one angle").row("rz", angle);
  }
  template <class T>
  static std::vector<T> rows(const Rigid<T>& model, const Observed<T>& measured) {
    return {rotation_vector(seen_from(model.rotation(), measured.frame.rotation()))[2]};
  }
};
TALUS_PLUGIN(Turn)

}  // namespace
}  // namespace talus
