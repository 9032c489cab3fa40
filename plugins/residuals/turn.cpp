#include "framework/registry/bind.h"

namespace talus {
namespace {

// Error of the turn about z alone: the direction of the measured x axis in the modelled xy plane.
// It keeps its meaning where the model's axis is tilted, or even reversed.
struct Turn {
  static Declaration declaration() {
    return residual("turn", {Kind::frame}, "error of the turn about z, one angle").row("rz", angle);
  }
  template <class T>
  static std::vector<T> rows(const Rigid<T>& model, const Observed<T>& measured) {
    using std::atan2;
    const auto error = seen_from(model.rotation(), measured.frame.rotation());
    return {atan2(error[1][0], error[0][0])};
  }
};
TALUS_PLUGIN(Turn)

}  // namespace
}  // namespace talus
