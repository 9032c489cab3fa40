#include "framework/registry/bind.h"

namespace talus {
namespace {

// Errors of the angles between the z axis of the feature's frame and the three axes of frame `in`
// (Nordquist and Hull 2009, eqs 6-8). The angle to axis i is acos(u_i), here
// atan2(sqrt(u_j^2 + u_k^2), u_i), which stays accurate near alignment. At alignment itself the
// angle has a corner; its derivative is taken as 0 there. Of a measured frame or direction the
// three are two; angles that were measured one by one are three, and of a machine whose axes are
// not square their cosines are no unit vector: 1 - u_i^2 then stands for u_j^2 + u_k^2.
struct InverseDirectionCosines {
  static Declaration declaration() {
    return residual(
               "inverse_direction_cosines", {Kind::frame, Kind::direction},
               "errors of the z axis' angles to the axes of frame `in` (Nordquist 2009, eqs 6-8)")
        .row("IDCx", angle)
        .row("IDCy", angle)
        .row("IDCz", angle)
        .dependent_rows();
  }
  template <class T>
  static Vector3<T> angles(const Vector3<T>& u, bool one_by_one = false) {
    using std::atan2;
    const Vector3<T> q{u[0] * u[0], u[1] * u[1], u[2] * u[2]};
    const T rest = one_by_one ? T(1) - (q[0] + q[1] + q[2]) : T(0);
    return {atan2(safe_sqrt(q[1] + q[2] + rest), u[0]), atan2(safe_sqrt(q[2] + q[0] + rest), u[1]),
            atan2(safe_sqrt(q[0] + q[1] + rest), u[2])};
  }
  template <class T>
  static std::vector<T> rows(const Rigid<T>& model, const Observed<T>& measured) {
    const Vector3<T> seen = measured.angles ? measured.vector
                            : measured.kind == Kind::frame
                                ? angles(column(measured.frame.rotation(), 2))
                                : angles(measured.vector);
    const Vector3<T> error = seen - angles(column(model.rotation(), 2), measured.angles);
    return {error[0], error[1], error[2]};
  }
};
TALUS_PLUGIN(InverseDirectionCosines)

}  // namespace
}  // namespace talus
