#include "framework/registry/bind.h"

namespace talus {
namespace {

// A closed loop: the frames `at` and `in`, reached over different ways, coincide. Nothing is
// measured, no column is read; the observed transform is the identity (closed-loop calibration,
// Hollerbach and Wampler, Int. J. Robotics Research 15 (1996), p. 573).
struct Closure {
  static Declaration declaration() {
    return feature("closure", Kind::nothing,
                   "closed loop: frames `at` and `in` coincide, nothing is measured (Hollerbach "
                   "and Wampler 1996)")
        .judged_by({"closure"});
  }
  template <class T>
  static Observed<T> observe() {
    return {};
  }
};
TALUS_PLUGIN(Closure)

}  // namespace
}  // namespace talus
