#include <set>

#include "framework/report/draw_scene.h"

namespace talus {

using Eigen::Isometry3d, Eigen::Vector3d;

std::vector<int> main_frames(const Program& program, const Skeleton& skeleton) {
  std::set<int> frames{0};
  for (const auto& [name, index] : program.frame_index)
    if (name != program.frames[index].name || skeleton.leaf(index)) frames.insert(index);
  for (const Feature& f : program.features)
    for (const std::string& name : program.chains[f.chain].key())
      frames.insert(program.frame(name, {}));
  for (const Limb& limb : program.limbs) frames.insert(limb.frame);
  return {frames.begin(), frames.end()};
}

std::optional<Vector3d> nearer_root(const Skeleton& skeleton, double size) {
  const Bone* only = nullptr;
  for (const Bone& bone : skeleton.bones())
    if (bone.from == 0) {
      if (only || skeleton.moves(bone.to)) return {};
      only = &bone;
    }
  if (!only) return {};
  const Vector3d to = only->points.back(), back = only->points.front() - to;
  if (!(size > 0) || back.norm() < 1.2 * size) return {};
  return to + 0.35 * size * back.normalized();
}

void extend(Points3& extent, const Program& program, const Posture& posture,
            const Skeleton& skeleton, const SceneOptions& options) {
  auto add = [&](const Vector3d& p) { extent.push_back(options.placement * p); };
  const bool far = options.near_root.has_value();
  for (const Bone& bone : skeleton.bones())
    for (const Vector3d& p : bone.points)
      if (!far || bone.from != 0 || &p == &bone.points.back()) add(p);
  for (int frame : options.triads)
    if (frame != 0 || !far) add(posture.frame(frame).translation());
  if (far) add(*options.near_root);
  for (const Isometry3d& feature : skeleton.features()) add(feature.translation());
  for (const Limb& limb : program.limbs) {
    const LimbPoints local = points(limb);
    for (int i = 0; i < 8; ++i) add(posture.frame(limb.frame) * local.col(i));
  }
}

}  // namespace talus
