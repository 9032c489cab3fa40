#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/report/draw.h"

namespace talus {

std::vector<double> resting_pose(const Program& program) {
  std::vector<double> pose;
  for (const Coordinate& c : coordinates(program)) pose.push_back(c.rest);
  return pose;
}

// Does a reading 360 deg further mean the same place? Then motion goes the short way round.
static bool turns_round(const Program& program, const Reading& reading) {
  if (reading.dimension != angle || reading.covariate) return false;
  std::vector<double> slots(program.slots, 0);
  for (const Parameter& p : program.parameters) slots[p.slot] = p.nominal.value;
  const std::int32_t node = reading.value.node_on(*program.tape);
  const double before = program.tape->evaluate(node, slots);
  slots[reading.slot] = 360 * deg;
  return std::abs(std::remainder(program.tape->evaluate(node, slots) - before, 360 * deg)) < 1e-9;
}

Settings interpolated(const Program& program, const Settings& settings, int between) {
  std::vector<bool> turns;
  for (const Reading& r : program.readings) turns.push_back(turns_round(program, r));
  for (const Unknown& u : program.unknowns) turns.push_back(u.dimension == angle);
  Settings result;
  for (std::size_t k = 0; k + 1 < settings.poses.size(); ++k)
    for (int i = 0; i <= between; ++i) {
      const double share = i / (between + 1.0);
      auto& pose = result.poses.emplace_back(settings.poses[k]);
      for (std::size_t c = 0; c < pose.size(); ++c) {
        double step = settings.poses[k + 1][c] - pose[c];
        if (turns[c]) step = std::remainder(step, 360 * deg);
        pose[c] += share * step;
      }
    }
  if (!settings.poses.empty()) result.poses.push_back(settings.poses.back());
  return result;
}

Settings same_poses(const Program& program, const Settings& settings, const Program& other,
                    const Place& place) {
  std::vector<std::vector<std::string>> names;  // of each coordinate of `program`
  for (const Coordinate& c : coordinates(program)) names.push_back({c.column, c.name});
  auto find = [&](const std::vector<std::string>& wanted) {
    for (const std::string& w : wanted)
      for (std::size_t i = 0; i < names.size(); ++i)
        if (std::find(names[i].begin(), names[i].end(), w) != names[i].end())
          return static_cast<int>(i);
    return -1;
  };
  std::vector<int> from;
  std::vector<std::string> theirs, ours;
  for (const Coordinate& c : coordinates(other))
    from.push_back(find({c.column, c.name})), theirs.push_back(c.name);
  for (const auto& n : names) ours.push_back(n.back());
  if (!from.empty() && !names.empty() &&
      std::all_of(from.begin(), from.end(), [](int i) { return i < 0; }))
    throw InputError(place, "its coordinates are " + join(theirs),
                     "one or more of those of the model: " + join(ours));
  Settings result;
  const std::vector<double> rest = resting_pose(other);
  for (const auto& pose : settings.poses) {
    auto& to = result.poses.emplace_back(rest);
    for (std::size_t i = 0; i < from.size(); ++i)
      if (from[i] >= 0) to[i] = pose[from[i]];
  }
  return result;
}

}  // namespace talus
