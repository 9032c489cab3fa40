#include "framework/kinematics/limb.h"

namespace talus {

LimbPoints points(const Limb& limb) {
  LimbPoints result;
  const Eigen::Vector3d half = limb.size / 2;
  for (int i = 0; i < 8; ++i) {
    const int corner = i % 4;
    const Eigen::Vector3d sign(corner == 1 || corner == 2 ? 1 : -1, corner >= 2 ? 1 : -1,
                               i >= 4 ? 1 : -1);
    result.col(i) = limb.centre + sign.cwiseProduct(half);
  }
  result.col(8) = limb.centre;
  for (int i = 0; i < 3; ++i) result.col(9 + i) = limb.centre + half[i] * Eigen::Vector3d::Unit(i);
  return result;
}

}  // namespace talus
