#include "framework/report/hinges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/calibration/settings.h"
#include "framework/kinematics/posture.h"

namespace talus {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kSame = 1e-9;  // mm and rad, of a motion that ought to be a pure turn

std::string turn_name(const std::string& joint) { return "turn of " + joint; }

class Finder {
 public:
  Finder(const Model& model, const Registry& registry, const Program& program)
      : model_(model), registry_(registry), program_(program) {}
  HingeChain run() {
    collect();
    sample();
    for (std::size_t i = 0; i < chain_.hinges.size(); ++i) orient(i);
    chain_.frames = samples_[0].frames;
    return std::move(chain_);
  }

 private:
  // The joints in order.
  void collect() {
    for (const Element& child : model_.root.children)
      if (child.tag == "chain")
        for (const Element& joint : child.children) chain_.joints[joint.name()] = &joint;
    const Posture posture(program_);
    std::set<int> moving;
    for (const JointAxis& axis : posture.axes()) moving.insert(axis.frame);
    chain_.body.assign(program_.frames.size(), 0);
    for (std::size_t f = 1; f < program_.frames.size(); ++f) {  // parents come first
      const int before = chain_.body[program_.frames[f].parent];
      chain_.body[f] = before;
      if (!moving.contains(static_cast<int>(f))) continue;
      const Frame& frame = program_.frames[f];
      if (before != static_cast<int>(chain_.hinges.size()))
        throw InputError(frame.place,
                         fmt::format("the chain branches: '{}' and '{}' both follow '{}'",
                                     chain_.hinges[before].element->name(), frame.name,
                                     before ? chain_.hinges[before - 1].element->name()
                                            : program_.frames[0].name),
                         "one chain of hinges");
      chain_.body[f] = before + 1;
      chain_.hinges.push_back(hinge(static_cast<int>(f)));
    }
    if (chain_.hinges.empty())
      throw InputError(model_.root.place, "the model has no joint that moves", "a chain of hinges");
  }

  ChainHinge hinge(int f) const {
    const Frame& frame = program_.frames[f];
    const Element& joint = *chain_.joints.at(frame.name);
    const Declaration& d = registry_.find(joint.tag, Family::joint)->declaration;
    ChainHinge result{f, &joint, {}, {}};
    int count = 0;
    for (const Input& input : d.inputs)
      if (input.coordinate) {
        ++count, result.coordinate = joint.text(input.name);
        if (input.dimension != angle)
          throw InputError(joint.place, fmt::format("joint '{}' slides", frame.name),
                           "joints that turn about one axis by their coordinate");
      }
    if (count != 1)
      throw InputError(joint.place,
                       fmt::format("joint '{}' moves, and <{}> has {} coordinates", frame.name,
                                   joint.tag, count ? std::to_string(count) : "no"),
                       "joints that turn about one axis by their coordinate");
    return result;
  }

  // Frames and coordinates' values at a reference posture (readings zero, unknowns at their start)
  // and at random ones. The values are read off a hinge added for each joint.
  void sample() {
    Model model = model_;
    for (const ChainHinge& h : chain_.hinges) {
      Element chain{"chain", {}, {}, h.element->place}, turn{"dh", {}, {}, h.element->place};
      chain.set("from", program_.frames[0].name);
      chain.set("to", turn_name(h.element->name()));
      turn.set("name", turn_name(h.element->name()));
      turn.set("theta", h.coordinate);
      chain.children.push_back(turn);
      model.root.children.push_back(chain);
    }
    const Program program = compile(model, registry_);
    Posture posture(program);
    std::vector<std::vector<double>> poses{{}};
    for (const Coordinate& c : coordinates(program)) poses[0].push_back(c.rest);
    for (auto& pose : random_settings(program, 12, 1).poses) poses.push_back(std::move(pose));
    for (const auto& pose : poses) {
      posture.set(pose);
      Sample s;
      for (const Frame& frame : program_.frames)
        s.frames.push_back(posture.frame(program.frame(frame.name, {})));
      for (const ChainHinge& h : chain_.hinges) {
        const auto R = posture.frame(program.frame(turn_name(h.element->name()), {})).linear();
        s.turns.push_back(std::atan2(R(1, 0), R(0, 0)));
      }
      const bool known = std::all_of(s.frames.begin(), s.frames.end(),
                                     [](const Isometry3d& T) { return T.matrix().allFinite(); });
      if (!known) continue;  // outside a sensor's domain
      if (samples_.empty())
        for (ChainHinge& h : chain_.hinges)
          for (const JointAxis& axis : posture.axes())
            if (axis.joint == h.element->name()) h.line = {axis.point, axis.direction};
      samples_.push_back(std::move(s));
    }
    if (samples_.size() < 2)
      throw InputError(model_.root.place, "no posture could be drawn within the sensors' ranges");
    for (std::size_t i = 0; i < chain_.hinges.size(); ++i)
      chain_.hinges[i].turn = samples_[0].turns[i];
  }

  // Directs the axis in the sense of the coordinate, and sees that the joint does nothing but turn.
  void orient(std::size_t i) {
    ChainHinge& h = chain_.hinges[i];
    const int parent = program_.frames[h.frame].parent;
    auto motion = [&](const Sample& s) { return s.frames[parent].inverse() * s.frames[h.frame]; };
    const Isometry3d to_joint = samples_[0].frames[h.frame].inverse();
    const Vector3d point = to_joint * h.line.point, axis = to_joint.linear() * h.line.direction;
    double worst[2] = {0, 0};
    for (const Sample& s : samples_) {
      const Isometry3d moved = motion(samples_[0]).inverse() * motion(s);
      for (int sense : {0, 1}) {
        const Isometry3d turned =
            Eigen::Translation3d(point) *
            Eigen::AngleAxisd((sense ? -1 : 1) * (s.turns[i] - samples_[0].turns[i]), axis) *
            Eigen::Translation3d(-point);
        worst[sense] = std::max(worst[sense], farthest(turned, moved));
      }
    }
    const double scale = 1 + point.norm();
    if (std::min(worst[0], worst[1]) > kSame * scale)
      throw InputError(h.element->place,
                       fmt::format("joint '{}' (<{}>) does not just turn about one axis by its "
                                   "coordinate '{}'",
                                   h.element->name(), h.element->tag, h.coordinate),
                       "hinges: dh has nothing else");
    if (worst[1] < worst[0]) h.line.direction = -h.line.direction;
  }

  HingeChain chain_;
  struct Sample {
    std::vector<Isometry3d> frames;  // of program_, in the root
    std::vector<double> turns;       // of the hinges, modulo a turn
  };
  std::vector<Sample> samples_;
  const Model& model_;
  const Registry& registry_;
  const Program& program_;
};

}  // namespace

double farthest(const Isometry3d& a, const Isometry3d& b) {
  const double most = (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
  return std::isfinite(most) ? most : 1e300;
}

HingeChain hinge_chain(const Model& model, const Registry& registry, const Program& program) {
  return Finder(model, registry, program).run();
}

}  // namespace talus
