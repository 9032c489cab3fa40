#include "framework/registry/bind.h"

namespace talus {
namespace {

// Skin and muscle carry the markers away from the bone as a joint moves (Leardini 2005).
struct SoftTissueArtefact {
  static Declaration declaration() {
    return effect(
               "soft_tissue_artefact", Acts::tip,
               "the markers' cluster slides on the bone by (x, y, z) q/per, q a joint's angle, and "
               "turns on it by (rx, ry, rz) q/per")
        .amount("x", length, 3, "along x of the measured frame at q = per")
        .amount("y", length, 3, "along y")
        .amount("z", length, 3, "along z")
        .amount("rx", angle, 2 * deg, "turn about x of the measured frame at q = per")
        .amount("ry", angle, 2 * deg, "turn about y")
        .amount("rz", angle, 2 * deg, "turn about z")
        .form({"x", "y", "z"})
        .form({"x", "y", "z", "rx", "ry", "rz"})
        .setting("per", angle, 30 * deg, {}, "angle to which the amounts refer")
        .driven_by(Driven::by_any, "the joint or unknown whose angle moves the skin")
        .shown(magnitude("displacement", "", {"x", "y", "z"}))
        .shown(magnitude("turn", "", {"rx", "ry", "rz"}))
        .reference("Leardini 2005");
  }
  template <class T>
  static Twist<T> act(const Around<T>& around, T x, T y, T z, T rx, T ry, T rz, T per) {
    const T q = around.driver / per;
    return {{x * q, y * q, z * q}, {rx * q, ry * q, rz * q}};
  }
};
TALUS_PLUGIN(SoftTissueArtefact)

}  // namespace
}  // namespace talus
