#include "framework/registry/bind.h"

namespace talus {
namespace {

// Joint angle set by a micrometer that is the third side of a triangle whose other sides, the bars,
// meet at the joint (law of cosines; Nordquist and Hull 2009, eq. 1):
// angle = +-acos((bar1^2 + bar2^2 - (reading + madj)^2) / (2 bar1 bar2)) + offset.
// The sense is "negative" where a longer third side turns the joint backwards. A third side that
// does not close the triangle gives no number.
struct MicrometerTriangle {
  static Declaration declaration() {
    return sensor("micrometer_triangle", length, angle,
                  "micrometer as third side of a triangle: +-acos((bar1^2 + bar2^2 - (reading + "
                  "madj)^2) / (2 bar1 bar2)) + offset (Nordquist 2009, eq. 1)")
        .required("bar1", length, "first bar, from the joint's axis")
        .required("bar2", length, "second bar, from the joint's axis")
        .input("madj", length, 0, "third side at reading zero")
        .input("offset", angle, 0, "added to the triangle's angle, its sense taken")
        .choice("sense", {"positive", "negative"},
                "whether a longer third side turns the joint forwards or backwards");
  }
  template <class T>
  static T value(T reading, T bar1, T bar2, T madj, T offset, int sense) {
    using std::acos;
    const T side = reading + madj;
    const T opposite = acos((bar1 * bar1 + bar2 * bar2 - side * side) / (T(2) * bar1 * bar2));
    return (sense == 0 ? opposite : -opposite) + offset;
  }
};
TALUS_PLUGIN(MicrometerTriangle)

}  // namespace
}  // namespace talus
