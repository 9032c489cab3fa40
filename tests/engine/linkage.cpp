#include "tests/engine/linkage.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace engine {
namespace {

// Bonny, Hull and Howell 2013: two links of 300 mm, axes at right angles.
Linkage spatial_linkage() {
  Linkage l;
  l.name = "isl";
  l.base = {{{{54, 2}, {-69, 2}, {0, 2}}}, "zxz", {{{0, 2}, {-90, 2}, {-60, 5}}}};
  l.links = {{{{0, 2}, {0, 2}, {90, 2}, {}, 0.18, {0, 0, 20}},
              {{300, 2}, {0, 2}, {90, 2}, {}, 0.26, {0, 150, 0}},
              {{0, 2}, {300, 2}, {90, 2}, {}, 0.26, {-150, 0, 0}},
              {{0, 2}, {0, 2}, {90, 2}, {}, 0.1, {0, 0, 10}},
              {{0, 2}, {0, 2}, {90, 2}, {}, 0.1, {0, 0, 10}},
              {{}, {}, {}, {}, 0.12, {0, -20, 40}}}};
  l.end = {{{{0, 2}, {-54, 2}, {94, 2}}}, "zxz", {{{90, 2}, {90, 2}, {0, 2}}}};
  const double intercepts[] = {150, 0, 210, 90, 270, 0};
  const double middles[] = {-45, -26, -20, -10, 38, 13};  // about what its fixture visits
  for (int i = 0; i < 6; ++i)
    l.encoders[i] = {
        {intercepts[i], i < 5 ? 2.0 : 0.0}, {1, 0.01}, 0.01, middles[i] - 60, middles[i] + 60};
  l.gravity = {-0.1696, -0.2545, -0.9521};
  l.held = l.frame = true;
  l.sigma_mm = 0.005, l.sigma_deg = 0.002;
  return l;
}

// Of the proportions of a PUMA 560, before a laser tracker.
Linkage arm() {
  Linkage l;
  l.name = "arm";
  l.base = {{{{1500, 10}, {-400, 10}, {671.83, 10}}}, "zyx", {{{0, 1}, {0, 1}, {0, 1}}}};
  l.links = {{{{}, {0, 0.75}, {-90, 0.3}, {}, 12, {0, 30, 60}},
              {{}, {431.8, 0.75}, {0, 0.3}, {0, 0.3}, 17.4, {-210, 6, 120}},
              {{149.09, 0.75}, {-20.32, 0.75}, {90, 0.3}, {}, 4.8, {10, -15, 40}},
              {{433.07, 0.75}, {0, 0.75}, {-90, 0.3}, {}, 0.82, {0, -80, 5}},
              {{0, 0.75}, {0, 0.75}, {90, 0.3}, {}, 0.34, {0, 0, 20}},
              {{}, {}, {}, {}, 0.09, {0, 0, 32}}}};
  l.end = {{{{40, 1}, {15, 1}, {180, 1}}}, "zxz", {}};
  const double low[] = {-150, -120, -60, -100, -95, -170}, high[] = {150, 30, 150, 100, 95, 170};
  for (int i = 0; i < 6; ++i)
    l.encoders[i] = {{0, i > 0 && i < 5 ? 0.3 : 0.0}, {1, 0}, 0.001, low[i], high[i]};
  l.gravity = {0, 0, -1};
  l.gravity_in_base = true;
  l.sigma_mm = 0.02;
  return l;
}

}  // namespace

const Flaw* Linkage::flaw(Flaw::Kind kind, int joint) const {
  const auto found = std::find_if(flaws.begin(), flaws.end(), [&](const Flaw& f) {
    return f.kind == kind && f.joint == joint;
  });
  return found == flaws.end() ? nullptr : &*found;
}

Linkage drawn(const std::string& name) {
  if (name == "isl") return spatial_linkage();
  if (name == "arm") return arm();
  throw std::runtime_error("no linkage \"" + name + "\": isl or arm");
}

Flaw read_flaw(const std::string& text) {
  static const std::vector<std::string> kinds{"elastic",   "tilting",       "bending",  "eccentric",
                                              "play_load", "play_approach", "clearance"};
  std::istringstream in(text);
  std::string kind, word;
  std::getline(in, kind, ':');
  const auto found = std::find(kinds.begin(), kinds.end(), kind);
  std::vector<double> numbers;
  while (std::getline(in, word, ':')) numbers.push_back(std::stod(word));
  if (found == kinds.end() || numbers.size() < 2 || numbers[0] < 1 || numbers[0] > 6)
    throw std::runtime_error("no flaw \"" + text +
                             "\": KIND:JOINT:SIZE[:EXTRA], for example elastic:2:0.0005");
  return {static_cast<Flaw::Kind>(found - kinds.begin()), static_cast<int>(numbers[0]), numbers[1],
          numbers.size() > 2 ? numbers[2] : 0};
}

Linkage built(Linkage l, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  auto off = [&](Toleranced& t) {
    t.value += t.tolerance / 3 * normal(random);
    t.tolerance = 0;
  };
  for (Mount* mount : {&l.base, &l.end}) {
    for (Toleranced& t : mount->shift) off(t);
    for (Toleranced& t : mount->turns) off(t);
  }
  for (Link& link : l.links)
    for (Toleranced* t : {&link.d, &link.a, &link.alpha, &link.beta}) off(*t);
  for (Encoder& e : l.encoders) off(e.intercept), off(e.slope);
  return l;
}

}  // namespace engine
