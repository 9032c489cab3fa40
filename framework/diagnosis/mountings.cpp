#include "framework/diagnosis/mountings.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "framework/calibration/load_columns.h"

namespace talus {
namespace {

constexpr double kSame = 5 * deg;  // directions nearer than this are one

bool fixed(const Expr& e) { return support(e).empty(); }

// Is the frame where it is whatever is calibrated, read or found?
bool stands_still(const Program& program, int frame) {
  for (; frame > 0; frame = program.frames[frame].parent)
    for (const Motion<Expr>& m : program.frames[frame].motion.motions()) {
      bool still = fixed(m.amount);
      for (int i = 0; i < 3; ++i) {
        still = still && fixed(m.translation[i]);
        for (int j = 0; j < 3; ++j) still = still && fixed(m.rotation[i][j]);
      }
      if (!still) return false;
    }
  return true;
}

}  // namespace

std::vector<Mounting> mountings(const Program& program) {
  if (loaded_frames(program).empty() || !stands_still(program, program.gravity->frame)) return {};
  const auto& d = program.gravity->direction;
  const Eigen::Vector3d now(d[0], d[1], d[2]);
  const std::string& name = program.frames[program.gravity->frame].name;
  std::vector<Mounting> result;
  auto offer = [&](double by, int axis) {
    Eigen::Vector3d down =  // seen from the frame
        Eigen::AngleAxisd(-by * deg, Eigen::Vector3d::Unit(axis)) * now;
    down = (1e9 * down).array().round() / 1e9;
    auto same = [&](const Eigen::Vector3d& other) { return down.dot(other) > std::cos(kSame); };
    if (same(now) ||
        std::any_of(result.begin(), result.end(), [&](const Mounting& m) { return same(m.down); }))
      return;
    result.push_back(
        {down, fmt::format("{} turned {:g} deg about its {} axis", name, by, "xyz"[axis])});
  };
  for (const double by : {90.0, -90.0, 180.0})
    for (int axis = 0; axis < 3; ++axis) offer(by, axis);
  return result;
}

}  // namespace talus
