#include "framework/report/dh_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/calibration/settings.h"
#include "framework/kinematics/angles.h"
#include "framework/kinematics/posture.h"
#include "framework/report/hinges.h"

namespace talus {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kSame = 1e-9;  // mm and rad, of frames that ought to be the same

Element element(const std::string& tag, const Place& place) { return {tag, {}, {}, place}; }

class Converter {
 public:
  Converter(const Model& model, const Registry& registry)
      : model_(model),
        registry_(registry),
        program_(compile(model, registry)),
        chain_(hinge_chain(model, registry, program_)) {}

  Model run() {
    for (const Element& child : model_.root.children) {
      const Plugin* plugin = registry_.find(child.tag);
      if (child.tag != "chain" && !(plugin && plugin->declaration.family == Family::sensor))
        mention(child);
    }
    std::vector<AxisLine> lines;
    for (const ChainHinge& hinge : chain_.hinges) lines.push_back(hinge.line);
    links_ = dh_links(lines);
    // The first and the last frame may turn about their axes, so that these joints need no offset.
    auto turned = [](double by) { return Isometry3d(Eigen::AngleAxisd(by, Vector3d::UnitZ())); };
    links_[0].theta = chain_.hinges[0].turn;
    links_[0].before = links_[0].before * turned(-links_[0].theta);
    if (links_.size() > 1) {
      links_.back().theta = chain_.hinges.back().turn;
      links_.back().behind = links_.back().before * turned(links_.back().theta);
    }
    Model result = write();
    check(result, lines);
    return result;
  }

 private:
  // Frames that the rest of the model names.
  void mention(const Element& e) {
    for (const Attribute& a : e.attributes)
      if (auto it = program_.frame_index.find(a.text);
          it != program_.frame_index.end() && it->second > 0)
        needed_.insert(a.text);
    for (const Element& child : e.children) mention(child);
  }

  // To so many digits that a picometre is not lost, and 90 is not 90.00000000000001.
  std::string number_text(double value, const Unit& unit) const {
    const double rounded = std::round(value / unit.factor * 1e12) / 1e12;
    return shortest(rounded == 0 ? 0 : rounded);
  }
  void put(Element& e, const char* name, double value, const Unit& unit) const {
    const std::string text = number_text(value, unit);
    if (text != "0") e.set(name, text);
  }

  Element placement(const char* tag, const std::string& name, const Isometry3d& T,
                    const Place& place) const {
    Element e = element(tag, place);
    e.set("name", name);
    e.set("order", "rpy");
    const auto yaw_pitch_roll = angles_of(T.linear(), {{2, 1, 0}});
    for (int i = 0; i < 3; ++i)
      put(e, std::array{"x", "y", "z"}[i], T.translation()[i], program_.units.length);
    for (int i = 0; i < 3; ++i)
      put(e, std::array{"a", "b", "c"}[i], yaw_pitch_roll[2 - i], program_.units.angle);
    return e;
  }

  std::string theta(const ChainHinge& h, const DhLink& link) const {
    const Unit& unit = program_.units.angle;
    double offset = std::remainder(link.theta - h.turn, 360 * deg);
    if (offset < -180 * deg + 1e-14) offset = 180 * deg;
    const std::string text = number_text(std::abs(offset), unit);
    if (text == "0") return h.coordinate;
    const bool plain = h.coordinate.find_first_of(" +-*/()") == std::string::npos;
    return fmt::format("{} {} {} {}", plain ? h.coordinate : "(" + h.coordinate + ")",
                       offset < 0 ? "-" : "+", text, unit.text);
  }

  // Frame behind DH joint `body` (0: the root) at the reference posture.
  Isometry3d carrier(int body) const {
    return body == 0 ? chain_.frames[0] : links_[body - 1].behind;
  }

  // All masses that a body's joints carry, at their common centre.
  void put_mass(Element& e, int body) const {
    double sum = 0;
    Vector3d moment = Vector3d::Zero();
    for (const Link& link : program_.links) {
      if (chain_.body[link.frame] != body) continue;
      const Vector3d centre(link.com[0], link.com[1], link.com[2]);
      sum += link.mass;
      moment += link.mass * (carrier(body).inverse() * (chain_.frames[link.frame] * centre));
    }
    if (sum == 0) return;
    e.set("mass", number_text(sum, Unit{"kg", mass}) + " kg");
    const Unit& unit = program_.units.length;
    moment /= sum;
    e.set("com", fmt::format("{}, {}, {}", number_text(moment.x(), unit),
                             number_text(moment.y(), unit), number_text(moment.z(), unit)));
  }

  std::string unused(std::string name, const std::set<std::string>& used) const {
    while (used.contains(name)) name += "_dh";
    return name;
  }

  Model write() const {
    std::set<std::string> used(needed_.begin(), needed_.end());
    used.insert(program_.frames[0].name);
    for (const Element& e : model_.root.children)
      if (e.tag != "chain") used.insert(e.name());
    const int n = static_cast<int>(chain_.hinges.size());
    // The chain ends at the last frame that is named behind the last joint.
    std::string end;
    for (const std::string& name : needed_) {
      const int f = program_.frame_index.at(name);
      if (chain_.body[f] == n && (end.empty() || f >= program_.frame_index.at(end))) end = name;
    }
    Element chain = element("chain", model_.root.place);
    chain.set("from", program_.frames[0].name);
    const std::string base = unused("base", used);
    used.insert(base);
    chain.children.push_back(
        placement("mount", base, links_[0].before, chain_.hinges[0].element->place));
    std::vector<std::string> carriers{program_.frames[0].name};
    for (int k = 0; k < n; ++k) {
      const ChainHinge& h = chain_.hinges[k];
      Element dh = element("dh", h.element->place);
      carriers.push_back(unused(h.element->name(), used));
      used.insert(carriers.back());
      dh.set("name", carriers.back());
      dh.set("theta", theta(h, links_[k]));
      put(dh, "d", links_[k].d, program_.units.length);
      put(dh, "a", links_[k].a, program_.units.length);
      put(dh, "alpha", links_[k].alpha, program_.units.angle);
      put_mass(dh, k + 1);
      chain.children.push_back(std::move(dh));
    }
    auto placed = [&](const char* tag, const std::string& name) {
      const int f = program_.frame_index.at(name);
      return placement(tag, name, carrier(chain_.body[f]).inverse() * chain_.frames[f],
                       program_.frames[f].place);
    };
    if (!end.empty()) chain.children.push_back(placed("mount", end));
    chain.set("to", end.empty() ? carriers.back() : end);
    std::vector<Element> chains{chain};
    for (const std::string& name : needed_) {
      if (name == end) continue;
      Element branch = element("chain", model_.root.place);
      branch.set("from", carriers[chain_.body[program_.frame_index.at(name)]]);
      branch.set("to", name);
      branch.children.push_back(placed("fixed", name));
      chains.push_back(std::move(branch));
    }
    Model result = model_;
    result.root.children.clear();
    bool done = false;
    for (const Element& child : model_.root.children) {
      if (child.tag != "chain") {
        result.root.children.push_back(child);
        continue;
      }
      if (!done) {
        result.root.children.insert(result.root.children.end(), chains.begin(), chains.end());
      }
      done = true;
    }
    return result;
  }

  // Every named frame is where it was, at postures of which the conversion knew nothing.
  void check(const Model& result, const std::vector<AxisLine>& lines) const {
    const Program program = compile(result, registry_);
    Posture before(program_), after(program);
    for (const auto& pose : random_settings(program_, 25, 2).poses) {
      before.set(pose);
      after.set(pose);
      for (const std::string& name : needed_) {
        const Isometry3d& was = before.frame(program_.frame(name, {}));
        if (!was.matrix().allFinite()) continue;
        const double off = farthest(was, after.frame(program.frame(name, {})));
        if (off > kSame * (1 + was.translation().norm()))
          throw InputError(
              model_.root.place,
              fmt::format("frame '{}' would be off by {:.2g}: the least angle between consecutive "
                          "axes is {:.2g} deg, so that their common normal is far away",
                          name, off, std::asin(least_sine(lines)) / deg),
              "axes that are parallel, or not nearly so; <dh_hayati> is for those that are nearly");
      }
    }
  }

  const Model& model_;
  const Registry& registry_;
  const Program program_;
  const HingeChain chain_;
  std::set<std::string> needed_;  // frames that the rest of the model names
  std::vector<DhLink> links_;
};

}  // namespace

Model dh_model(const Model& model, const Registry& registry) {
  return Converter(model, registry).run();
}

}  // namespace talus
