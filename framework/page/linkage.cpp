#include "framework/page/linkage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/calibration/settings.h"
#include "framework/kinematics/posture.h"
#include "framework/page/javascript.h"
#include "framework/page/page_state.h"
#include "framework/report/draw_scene.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Vector3d;

class Describer {
 public:
  Describer(const Program& program, const Recordings* recordings)
      : program_(program),
        recordings_(recordings),
        list_(coordinates(program)),
        posture_(program),
        skeleton_(program) {
    std::vector<double> rest;
    for (const Coordinate& c : list_) rest.push_back(c.rest);
    posture_.set(rest);
    skeleton_.set(posture_);
  }

  PageLinkage run() {
    const UnitSystem& units = program_.units;
    Json scene{{"name", program_.name},
               {"length", {{"unit", units.length.text}, {"factor", units.length.factor}}},
               {"angle", {{"unit", units.angle.text}, {"factor", units.angle.factor}}},
               {"slots", program_.slots}};
    scene["coordinates"] = coordinates_json();
    scene["frames"] = frames();
    scene["axes"] = axes();
    scene["bones"] = bones();
    scene["limbs"] = limbs();
    scene["features"] = features();
    scene["equations"] = equations();
    scene["size"] = wanted_.size();
    PageLinkage linkage{std::move(scene), javascript(*program_.tape, wanted_), wanted_};
    return linkage;
  }

 private:
  int want(const Expr& e) {
    wanted_.push_back(e.node_on(*program_.tape));
    return static_cast<int>(wanted_.size()) - 1;
  }
  int want(const Vector3<Expr>& v) {
    const int at = want(v[0]);
    want(v[1]), want(v[2]);
    return at;
  }
  int want(const Rigid<Expr>& T) {  // rows of the 3 x 4 matrix
    const Matrix3<Expr> R = T.rotation();
    const Vector3<Expr> p = T.translation();
    const int at = static_cast<int>(wanted_.size());
    for (int i = 0; i < 3; ++i) {
      want(R[i]);
      want(p[i]);
    }
    return at;
  }
  Vector3<Expr> point(const Origin& origin) const {
    const int parent = program_.frames[origin.frame].parent;
    Rigid<Expr> T = parent < 0 ? Rigid<Expr>() : posture_.placed(parent);
    const auto& motions = program_.frames[origin.frame].motion.motions();
    for (std::size_t i = 0; i < origin.motions; ++i) T = T * Rigid<Expr>(motions[i]);
    return T.translation();
  }

  int slot(std::size_t coordinate) const {
    return coordinate < program_.readings.size()
               ? program_.readings[coordinate].slot
               : program_.unknowns[coordinate - program_.readings.size()].slot;
  }

  bool limited(std::size_t i) const {
    return i < program_.readings.size()
               ? program_.readings[i].range.has_value()
               : program_.unknowns[i - program_.readings.size()].start.bounds.has_value();
  }

  std::pair<double, double> limits(std::size_t i) const {
    const Coordinate& c = list_[i];
    if (c.range && limited(i)) return *c.range;
    if (const RecordedColumn* column = recordings_ ? recordings_->find(c.column) : nullptr) {
      double low = INFINITY, high = -INFINITY;
      for (const double v : column->values)
        if (!std::isnan(v)) low = std::min(low, v), high = std::max(high, v);
      if (low < high) return {low, high};
    }
    if (c.range) return *c.range;
    const double reach = c.dimension == angle ? 60 * deg : c.dimension == length ? 50 : 1;
    return {c.rest - reach, c.rest + reach};
  }

  Json coordinates_json() const {
    Json out = Json::array();
    for (std::size_t i = 0; i < list_.size(); ++i) {
      const Coordinate& c = list_[i];
      const Unit unit = program_.units.of(c.dimension);
      const auto [low, high] = limits(i);
      out.push_back({{"name", c.name},
                     {"column", c.column},
                     {"unit", unit.text},
                     {"factor", unit.factor},
                     {"rest", rounded(c.rest / unit.factor, 12)},
                     {"low", rounded(low / unit.factor, 12)},
                     {"high", rounded(high / unit.factor, 12)},
                     {"limited", limited(i)},
                     {"circumstance", c.covariate},
                     {"slot", slot(i)}});
      if (i >= program_.readings.size())
        out.back()["shared"] = !program_.unknowns[i - program_.readings.size()].per.empty();
    }
    return out;
  }

  std::string label(int frame) const {
    for (const auto& [name, index] : program_.frame_index)
      if (index == frame && name != program_.frames[frame].name) return name;
    return program_.frames[frame].name;
  }

  Json frames() {
    const std::vector<int> main = main_frames(program_, skeleton_);
    Json out = Json::array();
    for (std::size_t f = 0; f < program_.frames.size(); ++f) {
      const int frame = static_cast<int>(f);
      out.push_back({{"name", program_.frames[f].name},
                     {"label", label(frame)},
                     {"parent", program_.frames[f].parent},
                     {"main", std::find(main.begin(), main.end(), frame) != main.end()},
                     {"at", want(posture_.placed(frame))}});
    }
    return out;
  }

  // Those that lie on one line of one joint are one axis, moved by several coordinates.
  Json axes() {
    const std::vector<JointAxis>& all = posture_.axes();
    std::vector<int> number(all.size());
    std::vector<Vector3d> centres;
    Json out = Json::array();
    for (std::size_t i = 0; i < all.size(); ++i) {
      const JointAxis& axis = all[i];
      bool again = false;
      for (std::size_t j = 0; j < i && !again; ++j) {
        const Apart to = apart(axis, all[j]);
        again = all[j].frame == axis.frame && std::sin(to.angle) < 1e-6 && to.distance < 1e-6;
        if (again) number[i] = number[j];
      }
      if (again) {
        out[number[i]]["coordinates"].push_back(axis.coordinate);
        continue;
      }
      number[i] = static_cast<int>(out.size());
      const int before = axis_before(program_, all, i);
      const Vector3d centre = skeleton_.centre(axis.frame);
      const Vector3d across = centre - axis.point;
      const bool off =
          axis.turns && (across - across.dot(axis.direction) * axis.direction).norm() > 1e-6;
      const Vector3d shown = off ? axis.point : centre;
      const auto met = std::count_if(centres.begin(), centres.end(),
                                     [&](const Vector3d& c) { return (c - shown).norm() < 1; });
      centres.push_back(shown);
      const auto& [w, slide] = posture_.twist(i);
      Json entry{{"joint", axis.joint},
                 {"frame", axis.frame},
                 {"coordinates", {axis.coordinate}},
                 {"before", before < 0 ? -1 : number[before]},
                 {"moves", skeleton_.moves(axis.frame)},
                 {"met", met},
                 {"turn", want(w)}};
      entry["slide"] = want(slide);
      entry["centre"] = want(point(skeleton_.centre_origin(axis.frame)));
      out.push_back(std::move(entry));
    }
    return out;
  }

  Json bones() {
    double size = 0;
    for (const Bone& bone : skeleton_.bones())
      if (bone.from != 0)
        for (const Vector3d& p : bone.points)
          for (const Vector3d& q : skeleton_.bones().back().points)
            size = std::max(size, (p - q).norm());
    const bool far = nearer_root(skeleton_, size).has_value();
    Json out = Json::array();
    for (const Bone& bone : skeleton_.bones()) {
      const int body = skeleton_.body(bone.from);
      const bool limbed =
          std::any_of(program_.limbs.begin(), program_.limbs.end(),
                      [&](const Limb& l) { return skeleton_.body(l.frame) == body; });
      Json points = Json::array();
      for (const Origin& origin : bone.origins) points.push_back(want(point(origin)));
      out.push_back({{"from", bone.from},
                     {"to", bone.to},
                     {"body", body},
                     {"limbed", limbed},
                     {"stem", body == 0 || (bone.to != bone.from && !skeleton_.moves(bone.to) &&
                                            skeleton_.leaf(bone.to))},
                     {"far", far && bone.from == 0},
                     {"points", std::move(points)}});
    }
    return out;
  }

  Json limbs() const {
    Json out = Json::array();
    auto list = [](const Vector3d& v) { return Json{v[0], v[1], v[2]}; };
    for (const Limb& limb : program_.limbs)
      out.push_back({{"name", limb.name},
                     {"frame", limb.frame},
                     {"body", skeleton_.body(limb.frame)},
                     {"centre", list(limb.centre)},
                     {"size", list(limb.size)}});
    return out;
  }

  Json features() {
    Json out = Json::array();
    for (const Feature& f : program_.features) {
      const Chain& chain = program_.chains[f.chain];
      const int in = program_.frame(chain.in, {});
      Json entry{{"name", f.name},
                 {"tag", f.tag},
                 {"kind", to_string(f.kind)},
                 {"in", in},
                 {"frame", program_.frame(chain.at, {})}};
      Rigid<Expr> T = posture_.placed(in);
      for (const Motion<Expr>& m : chain.motions.motions()) {
        const Rigid<Expr> next = T * Rigid<Expr>(m);
        T = Rigid<Expr>(next.rotation(), next.translation());
      }
      entry["at"] = want(T);
      out.push_back(std::move(entry));
    }
    return out;
  }

  // Each joint as the product of its elementary motions.
  Json equations() const {
    Json out = Json::array();
    for (std::size_t f = 0; f < program_.frames.size(); ++f) {
      const Frame& frame = program_.frames[f];
      if (frame.parent < 0) continue;
      Json motions = Json::array();
      for (const Motion<Expr>& m : frame.motion.motions()) motions.push_back(motion(m));
      out.push_back({{"frame", f}, {"parent", frame.parent}, {"motions", std::move(motions)}});
    }
    for (const Reading& r : program_.readings)
      if (!r.covariate)
        out.push_back(
            {{"reading", r.sensor}, {"column", r.column}, {"text", text(r.value, r.dimension)}});
    return out;
  }

  std::string text(const Expr& e, Dimension dimension) const {
    if (!e.is_constant()) {
      const std::string words = formula(e, program_.slot_names);
      return words.size() <= 300 ? words : fmt::format("a formula of {} letters", words.size());
    }
    const Unit unit = program_.units.of(dimension);
    return fmt::format("{:.6g} {}", e.constant() / unit.factor, unit.text);
  }

  Json motion(const Motion<Expr>& m) const {
    static constexpr const char* axes[] = {"x", "y", "z"};
    if (m.kind == Motion<Expr>::Kind::matrix)
      return {{"kind", "matrix"}, {"text", "a rotation matrix and a translation"}};
    const bool turns = m.kind == Motion<Expr>::Kind::rotation;
    return {{"kind", turns ? "R" : "T"},
            {"axis", axes[m.axis]},
            {"text", text(m.amount, turns ? angle : length)}};
  }

  const Program& program_;
  const Recordings* recordings_;
  std::vector<Coordinate> list_;
  Posture posture_;
  Skeleton skeleton_;
  std::vector<std::int32_t> wanted_;
};

}  // namespace

PageLinkage page_linkage(const Program& program, const Recordings* recordings) {
  return Describer(program, recordings).run();
}

std::vector<double> page_slots(const Program& program, std::span<const double> parameters) {
  std::vector<double> rest;
  for (const Coordinate& c : coordinates(program)) rest.push_back(c.rest);
  Posture posture(program);
  posture.set(rest, parameters);
  return posture.slots();
}

}  // namespace talus
