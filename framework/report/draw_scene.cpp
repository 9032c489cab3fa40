#include "framework/report/draw_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

using Eigen::Isometry3d, Eigen::Vector3d;

// Okabe and Ito's and Tol's colours: told apart by the colour-blind, and in grey by their
// lightness.
constexpr Colour triad_colours[] = {0xd55e00, 0x009e73, 0x0072b2};
constexpr Colour limb_fills[] = {0xbbccee, 0xeeeebb, 0xffcccc, 0xccddaa, 0xcceeff, 0xdddddd};
constexpr Colour limb_edge = 0x55606b, rod_edge = 0x4d5862, joint_fill = 0xf0b030,
                 joint_edge = 0x7a5000, ink = 0x222222;
constexpr Colour rod_fills[] = {0x97a3af, 0xc6ced6};

// Lengths in units of the page (a thousandth of its width).
constexpr double triad_length = 40, barrel_radius = 9, barrel_half = 15, rod_radius = 4.5,
                 stem_radius = 1.8, axis_beyond = 26, ray_length = 90;

class Painter {
 public:
  Painter(Scene& scene, const Program& program, const Posture& posture, const Skeleton& skeleton,
          const SceneOptions& options)
      : scene_(scene), program_(program), skeleton_(skeleton), o_(options) {
    for (std::size_t f = 0; f < program.frames.size(); ++f)
      frames_.push_back(o_.placement * posture.frame(static_cast<int>(f)));
    axes_ = posture.axes();
    for (JointAxis& axis : axes_) {
      axis.point = o_.placement * axis.point;
      axis.direction = o_.placement.linear() * axis.direction;
    }
  }

  void all() {
    for (std::size_t i = 0; i < program_.limbs.size(); ++i) limb(i);
    for (const Bone& bone : skeleton_.bones()) this->bone(bone);
    joints();
    for (int frame : o_.triads) triad(frame);
    for (std::size_t i = 0; i < program_.features.size(); ++i) feature(i);
  }

 private:
  double mm(double units) const { return units * o_.unit; }
  bool ghost() const { return o_.ghost.has_value(); }
  Colour or_ghost(Colour colour) const { return o_.ghost.value_or(colour); }
  void name(const Vector3d& at, const Vector3d& towards, const std::string& text, Colour colour,
            double size, bool bold, bool slanted) {
    // One label for what lies at one point and is of one sort; a ghost's name is told only where it
    // is not that of the linkage at about the same place.
    for (Name& other : scene_.names) {
      const double apart = (other.at - at).norm();
      if (ghost() && other.text == text && apart < mm(60)) return;
      if (other.colour != colour || apart > mm(0.5) || other.slanted != slanted) continue;
      if (other.text != text) other.text += ", " + text;
      return;
    }
    scene_.names.push_back({at, towards, text, colour, size, bold, slanted, text});
    if (ghost()) scene_.names.back().key += " (ghost)";
  }

  void limb(std::size_t index) {
    const Limb& limb = program_.limbs[index];
    const LimbPoints local = points(limb);
    Points3 p;
    for (int i = 0; i < 12; ++i) p.push_back(frames_[limb.frame] * local.col(i));
    static constexpr int faces[6][4] = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                        {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    if (ghost()) {
      for (int i = 0; i < 4; ++i)
        for (auto [a, b] : {std::pair(i, (i + 1) % 4), {4 + i, 4 + (i + 1) % 4}, {i, 4 + i}})
          scene_.strokes.push_back({p[a], p[b], *o_.ghost, 0.8});
      return;
    }
    for (const auto& face : faces)
      scene_.faces.push_back({{p[face[0]], p[face[1]], p[face[2]], p[face[3]]},
                              limb_fills[index % std::size(limb_fills)],
                              limb_edge,
                              0.8});
    if (limb.name != label(limb.frame) || !shown(limb.frame))
      name(p[8], p[8], limb.name, 0x3d4852, 13, false, true);
  }

  // The root is farther away than the picture reaches: a broken line to where it would be.
  void far_root(const Vector3d& to, int frame) {
    const Vector3d from = o_.placement * *o_.near_root;
    scene_.strokes.push_back({from, to, or_ghost(rod_edge), ghost() ? 1.0 : 1.4, {6, 5}});
    if (ghost()) return;
    const Vector3d origin = frames_[0].translation();
    name(from + 0.5 * (to - from), to,
         fmt::format("{:.4g} mm", (frames_[frame].translation() - origin).norm()), rod_edge, 12,
         false, true);
  }

  bool has_limb(int frame) const {
    return std::any_of(program_.limbs.begin(), program_.limbs.end(), [&](const Limb& l) {
      return skeleton_.body(l.frame) == skeleton_.body(frame);
    });
  }

  // A joint outside the limbs of its body hangs on the nearest of them.
  void stem_to_limb(int body, const Vector3d& end) {
    std::optional<Vector3d> nearest;
    for (const Limb& limb : program_.limbs) {
      if (skeleton_.body(limb.frame) != body) continue;
      const Vector3d local = frames_[limb.frame].inverse() * end, half = limb.size / 2;
      const Vector3d p = frames_[limb.frame] *
                         local.cwiseMax(limb.centre - half).cwiseMin(limb.centre + half).eval();
      if (!nearest || (p - end).norm() < (*nearest - end).norm()) nearest = p;
    }
    if ((*nearest - end).norm() < mm(barrel_radius)) return;
    if (ghost())
      scene_.strokes.push_back({*nearest, end, *o_.ghost, 1.0});
    else
      scene_.rods.push_back({*nearest, end, mm(stem_radius), rod_fills[body % 2], rod_edge});
  }

  void bone(const Bone& bone) {
    const int body = skeleton_.body(bone.from);
    if (has_limb(bone.from)) {
      for (const Vector3d& end : {bone.points.front(), bone.points.back()})
        stem_to_limb(body, o_.placement * end);
      return;
    }
    const bool stem =
        body == 0 || (bone.to != bone.from && !skeleton_.moves(bone.to) && skeleton_.leaf(bone.to));
    for (std::size_t i = 1; i < bone.points.size(); ++i) {
      const Vector3d a = o_.placement * bone.points[i - 1], b = o_.placement * bone.points[i];
      if ((b - a).norm() < mm(0.2)) continue;
      if (o_.near_root && body == 0 && bone.from == 0) {
        far_root(b, bone.to);
        continue;
      }
      if (ghost()) {
        scene_.strokes.push_back({a, b, *o_.ghost, 1.6});
      } else {
        scene_.rods.push_back(
            {a, b, mm(stem ? stem_radius : rod_radius), rod_fills[body % 2], rod_edge});
      }
    }
  }

  void joints() {
    std::vector<Vector3d> centres;
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      const JointAxis& axis = axes_[i];
      const bool again = std::any_of(axes_.begin(), axes_.begin() + static_cast<std::ptrdiff_t>(i),
                                     [&](const JointAxis& other) {
                                       const Apart to = apart(axis, other);
                                       return other.frame == axis.frame &&
                                              std::sin(to.angle) < 1e-6 && to.distance < 1e-6;
                                     });
      if (again || !skeleton_.moves(axis.frame) || !(axis.direction.norm() > 0.5)) continue;
      Vector3d centre = o_.placement * skeleton_.centre(axis.frame);
      const Vector3d across = centre - axis.point;
      if (axis.turns && (across - across.dot(axis.direction) * axis.direction).norm() > mm(0.1))
        centre = axis.point;
      // Axes that meet: each further barrel is thinner and longer than the one before.
      const auto met = std::count_if(centres.begin(), centres.end(), [&](const Vector3d& c) {
        return (c - centre).norm() < mm(barrel_radius);
      });
      centres.push_back(centre);
      const double n = std::min(5.0, static_cast<double>(met));
      joint(axis, centre, barrel_radius * std::pow(0.74, n), barrel_half * std::pow(1.32, n));
    }
  }

  void joint(const JointAxis& axis, const Vector3d& centre, double radius, double half) {
    const Vector3d reach = mm(half + axis_beyond) * axis.direction;
    if (ghost()) {
      scene_.strokes.push_back(
          {centre - 0.7 * reach, centre + 0.7 * reach, *o_.ghost, 0.9, {9, 2.5, 1.5, 2.5}});
      scene_.rings.push_back({centre, 2.6, *o_.ghost});
      return;
    }
    if (axis.turns)
      scene_.barrels.push_back(
          {centre, axis.direction, mm(radius), mm(half), joint_fill, joint_edge});
    else
      block(centre, axis.direction, mm(radius), mm(half));
    scene_.strokes.push_back({centre - reach,
                              centre + reach,
                              joint_edge,
                              1.1,
                              {10, 3, 2, 3},
                              axis.turns ? Tip::arrow : Tip::both});
    name(centre + reach, centre + 2 * reach, axis.joint, joint_edge, 12.5, false, true);
  }

  // The sleeve of a sliding joint.
  void block(const Vector3d& centre, const Vector3d& z, double radius, double half) {
    const Vector3d x = z.unitOrthogonal(), y = z.cross(x);
    auto corner = [&](int sx, int sy, int sz) {
      return Vector3d(centre + radius * (sx * x + sy * y) + half * sz * z);
    };
    auto face = [&](std::array<std::array<int, 3>, 4> c) {
      Points3 p;
      for (const auto& s : c) p.push_back(corner(s[0], s[1], s[2]));
      scene_.faces.push_back({p, joint_fill, joint_edge});
    };
    face({{{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}});
    face({{{-1, 1, -1}, {1, 1, -1}, {1, -1, -1}, {-1, -1, -1}}});
    face({{{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}}});
    face({{{-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1}, {-1, -1, -1}}});
    face({{{-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}}});
    face({{{1, -1, -1}, {1, -1, 1}, {-1, -1, 1}, {-1, -1, -1}}});
  }

  Vector3d origin(int frame) const {
    if (frame == 0 && o_.near_root) return o_.placement * *o_.near_root;
    return frames_[frame].translation();
  }

  // The name that a chain gives to its end comes before that of the joint there.
  std::string label(int frame) const {
    for (const auto& [name, index] : program_.frame_index)
      if (index == frame && name != program_.frames[frame].name) return name;
    return program_.frames[frame].name;
  }
  bool shown(int frame) const {
    return std::find(o_.triads.begin(), o_.triads.end(), frame) != o_.triads.end();
  }

  void triad(int frame) {
    const Isometry3d& T = frames_[frame];
    const Vector3d origin = this->origin(frame);
    if (ghost() && std::any_of(scene_.triads.begin(), scene_.triads.end(), [&](const auto& other) {
          return (other.translation() - T.translation()).norm() < mm(1) &&
                 (other.linear() - T.linear()).norm() < 0.01;
        }))
      return;  // where the linkage's own is
    scene_.triads.push_back(T);
    const double length = mm(ghost() ? 0.7 * triad_length : triad_length);
    for (int i = 0; i < 3; ++i)
      scene_.strokes.push_back({origin,
                                origin + length * T.linear().col(i),
                                or_ghost(triad_colours[i]),
                                ghost() ? 1.0 : 2.2,
                                {},
                                Tip::arrow});
    if (!ghost())
      for (int i = 0; i < 3; ++i)
        scene_.names.push_back({origin + length * T.linear().col(i),
                                origin + 2 * length * T.linear().col(i), std::string(1, "xyz"[i]),
                                triad_colours[i], 10.5, false, true,
                                label(frame) + "." + "xyz"[i]});
    const Vector3d away = T.linear().rowwise().sum();
    name(origin, origin - length * away, label(frame), or_ghost(ink), ghost() ? 12.5 : 15, !ghost(),
         false);
  }

  void feature(std::size_t index) {
    const Feature& f = program_.features[index];
    if (ghost()) return;
    const Chain& chain = program_.chains[f.chain];
    const int in = program_.frame(chain.in, {}), at = program_.frame(chain.at, {});
    const Isometry3d T = o_.placement * skeleton_.features()[index];
    const Vector3d p = T.translation(), from = origin(in), held = frames_[at].translation();
    if ((p - held).norm() > mm(1)) scene_.strokes.push_back({held, p, limb_edge, 1.2});
    const bool named = f.name != label(at) || !shown(at);
    Vector3d anchor = p;
    if (f.kind == Kind::scalar) {
      scene_.strokes.push_back({from, p, ink, 0.9, {5, 4}, Tip::both});
      anchor = 0.5 * (from + p);
    } else if (f.kind == Kind::direction) {
      anchor = p + mm(ray_length) * T.linear().col(2);
      scene_.strokes.push_back({p, anchor, ink, 1.4, {7, 4}, Tip::arrow});
    } else if (f.kind == Kind::nothing && (p - from).norm() > mm(1)) {
      scene_.strokes.push_back({p, from, ink, 1, {2, 4}});
    }
    if (f.kind != Kind::direction) scene_.rings.push_back({p, 4.2, ink});
    if (named) name(anchor, anchor + (anchor - from), f.name, ink, 13, false, true);
  }

  Scene& scene_;
  const Program& program_;
  const Skeleton& skeleton_;
  const SceneOptions& o_;
  std::vector<Isometry3d> frames_;
  std::vector<JointAxis> axes_;
};

}  // namespace

void add_linkage(Scene& scene, const Program& program, const Posture& posture,
                 const Skeleton& skeleton, const SceneOptions& options) {
  Painter(scene, program, posture, skeleton, options).all();
}

}  // namespace talus
