#include "framework/registry/bind.h"

namespace talus {
namespace {

// Error of a frame as that of four points it carries: its origin and the points `arm` along its
// three axes, measured minus modelled, in frame `in`. Position and orientation so have one unit,
// the arm weighing them (the "measuring points" way to make a pose error homogeneous in length).
struct FramePoints {
  static Declaration declaration() {
    Declaration d = residual(
        "frame_points", {Kind::frame},
        "error of a frame as that of its origin and of three points along its axes, all lengths");
    d.input("arm", length, 100, "distance of the three points from the origin");
    for (const char* point : {"o", "x", "y", "z"})
      for (const char* axis : {"x", "y", "z"}) d.row(std::string(point) + axis, length);
    return d;
  }
  template <class T>
  static std::vector<T> rows(const Rigid<T>& model, const Observed<T>& measured, T arm) {
    const Vector3<T> error = measured.frame.translation() - model.translation();
    const Matrix3<T> R = model.rotation(), seen = measured.frame.rotation();
    std::vector<T> result{error[0], error[1], error[2]};
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) result.push_back(error[i] + arm * (seen[i][j] - R[i][j]));
    return result;
  }
};
TALUS_PLUGIN(FramePoints)

}  // namespace
}  // namespace talus
