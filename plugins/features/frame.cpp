#include "framework/registry/bind.h"

namespace talus {
namespace {

// A measured frame: position and quaternion (w, x, y, z; either sign, any length but zero) of the
// frame `at` in the frame `in`, as a coordinate measuring machine or a marker cluster gives them.
struct Frame {
  static Declaration declaration() {
    return feature("frame", Kind::frame,
                   "measured frame: position and quaternion in frame `in` (Bonny 2013, sec. 2.2)")
        .column(".x", length)
        .column(".y", length)
        .column(".z", length)
        .column(".qw", number)
        .column(".qx", number)
        .column(".qy", number)
        .column(".qz", number)
        .judged_by({"position", "rotation_vector"});
  }
  template <class T>
  static Observed<T> observe(T x, T y, T z, T qw, T qx, T qy, T qz) {
    return {.kind = Kind::frame, .frame = from_quaternion<T>({x, y, z}, qw, qx, qy, qz)};
  }
};
TALUS_PLUGIN(Frame)

}  // namespace
}  // namespace talus
