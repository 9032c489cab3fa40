#include "framework/kinematics/skeleton.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace talus {

using Eigen::Isometry3d, Eigen::Vector3d;

// Straight where the legs are neither in line nor at right angles: then they lead to a frame that
// lies somewhere, not along the body.
void Skeleton::straighten(Points& points) {
  Points kept{points[0]};
  double size = 0;
  for (const Point& p : points) size = std::max(size, (p.at - points[0].at).norm());
  for (const Point& p : points)
    if ((p.at - kept.back().at).norm() > 1e-6 * size) kept.push_back(p);
  for (std::size_t i = 1; i < kept.size(); ++i)
    for (std::size_t j = i + 1; j < kept.size(); ++j) {
      const Vector3d a = kept[i].at - kept[i - 1].at, b = kept[j].at - kept[j - 1].at;
      const double cosine = a.normalized().dot(b.normalized());
      if (std::abs(cosine) > 0.02 && cosine < 0.999) {
        points = {points.front(), points.back()};
        return;
      }
    }
  points = std::move(kept);
}

Skeleton::Skeleton(const Program& program)
    : program_(&program),
      coordinate_(program.slots),
      joints_(program.frames.size()),
      before_(program.frames.size()),
      after_(program.frames.size()),
      centres_(program.frames.size()) {
  for (const Reading& r : program.readings) coordinate_[r.slot] = !r.covariate;
  for (const Unknown& u : program.unknowns) coordinate_[u.slot] = u.per.empty();
  std::vector<std::int32_t> nodes;
  std::set<int> ends;  // frames to which something is fastened
  for (const Limb& limb : program.limbs) ends.insert(limb.frame);
  for (const talus::Feature& f : program.features) {
    const Chain& chain = program.chains[f.chain];
    const int in = program.frame(chain.in, {});
    measured_.push_back({in, steps_of(chain.motions, nodes)});
    ends.insert({in, program.frame(chain.at, {})});
  }
  for (std::size_t f = 0; f < joints_.size(); ++f) {
    Joint& joint = joints_[f];
    const int parent = program.frames[f].parent;
    joint.steps = steps_of(program.frames[f].motion, nodes);
    joint.moves =
        std::any_of(joint.steps.begin(), joint.steps.end(), [](const Step& s) { return s.moves; });
    joint.body = joint.moves || parent < 0 ? static_cast<int>(f) : joints_[parent].body;
    if (parent < 0) continue;
    joints_[parent].leaf = false;
    bones_.push_back({parent, static_cast<int>(f), {}});
  }
  for (std::size_t f = 0; f < joints_.size(); ++f)
    if (joints_[f].moves && (joints_[f].leaf || ends.contains(static_cast<int>(f))))
      bones_.push_back({static_cast<int>(f), static_cast<int>(f), {}});
  features_.resize(measured_.size());
  values_ = TapeValues(*program.tape, std::move(nodes));
}

std::vector<Skeleton::Step> Skeleton::steps_of(const Rigid<Expr>& motion,
                                               std::vector<std::int32_t>& nodes) const {
  std::vector<Step> steps;
  for (const Motion<Expr>& m : motion.motions()) {
    Step step{m.kind, m.axis, nodes.size(), false};
    auto want = [&](const Expr& e) {
      nodes.push_back(e.node_on(*program_->tape));
      for (int slot : support(e)) step.moves = step.moves || coordinate_[slot];
    };
    if (m.kind != Motion<Expr>::Kind::matrix) {
      want(m.amount);
    } else {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) want(m.rotation[i][j]);
        want(m.translation[i]);
      }
    }
    steps.push_back(step);
  }
  return steps;
}

void Skeleton::apply(const Step& step, const std::vector<double>& values, Isometry3d& T) {
  const double* v = &values[step.value];
  const Vector3d axis = Vector3d::Unit(step.axis);
  if (step.kind == Motion<Expr>::Kind::rotation) {
    T.rotate(Eigen::AngleAxisd(*v, axis));
  } else if (step.kind == Motion<Expr>::Kind::translation) {
    T.translate(*v * axis);
  } else {
    Isometry3d M = Isometry3d::Identity();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j) M.matrix()(i, j) = *v++;
    T = T * M;
  }
}

// The points from the frame before the joint to its own. Translations along x, then y, then z are
// one placement, hence one leg; along z, then x, they are the offsets d and a.
void Skeleton::walk(int frame, const Posture& posture, const std::vector<double>& values) {
  const int parent = program_->frames[frame].parent;
  Isometry3d T = parent < 0 ? Isometry3d::Identity() : posture.frame(parent);
  Points *points = &before_[frame], &after = after_[frame];
  std::size_t made = 0;  // motions so far
  auto here = [&] { return Point{T.translation(), {frame, made}}; };
  points->assign(1, here());
  after.clear();
  int last = 3;  // the axis of the translation before this step, if there was one
  for (const Step& step : joints_[frame].steps) {
    if (step.moves && points != &after) {
      points = &after;
      points->assign(1, here());
      last = 3;
    }
    apply(step, values, T);
    ++made;
    const bool translation = step.kind == Motion<Expr>::Kind::translation;
    if (translation && last < step.axis)
      points->back() = here();
    else if (step.kind != Motion<Expr>::Kind::rotation)
      points->push_back(here());
    last = translation ? step.axis : 3;
  }
  if (after.empty()) after = {here()};  // nothing moves: the frame's origin
  centres_[frame] = after[0];
}

// A hinge through a point goes there, turns and goes back again: to a frame beside the body.
bool Skeleton::returns(int frame) const {
  const double there = (before_[frame].back().at - before_[frame].front().at).norm(),
               back = (after_[frame].back().at - after_[frame].front().at).norm();
  return there > 0 && std::abs(there - back) < 1e-9 * there;
}

void Skeleton::set(const Posture& posture) {
  const std::vector<double>& values = values_(posture.slots());
  for (std::size_t f = 0; f < joints_.size(); ++f) walk(static_cast<int>(f), posture, values);
  for (Bone& bone : bones_) {
    Points points = after_[bone.from];
    if (bone.to != bone.from)
      points.insert(points.end(), before_[bone.to].begin(), before_[bone.to].end());
    if (bone.to != bone.from && returns(bone.from)) points = {points.front(), points.back()};
    straighten(points);
    bone.points.clear();
    bone.origins.clear();
    for (const Point& p : points) bone.points.push_back(p.at), bone.origins.push_back(p.origin);
  }
  for (std::size_t i = 0; i < measured_.size(); ++i) {
    features_[i] = posture.frame(measured_[i].in);
    for (const Step& step : measured_[i].steps) apply(step, values, features_[i]);
  }
}

}  // namespace talus
