#include "framework/registry/bind.h"

namespace talus {
namespace {

// Error of the distance from the origin of frame `in`: P_measured - |p_model| (Nordquist and Hull
// 2009, eq. 9). Of a measured frame or point, P_measured is the length of its position.
struct VectorLength {
  static Declaration declaration() {
    return residual("vector_length", {Kind::frame, Kind::point, Kind::scalar},
                    "error of the distance from the origin of frame `in` (Nordquist 2009, eq. 9)")
        .row("P", length);
  }
  template <class T>
  static std::vector<T> rows(const Rigid<T>& model, const Observed<T>& measured) {
    const T seen =
        measured.kind == Kind::scalar ? measured.scalar : norm(measured.frame.translation());
    return {seen - norm(model.translation())};
  }
};
TALUS_PLUGIN(VectorLength)

}  // namespace
}  // namespace talus
