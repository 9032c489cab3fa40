#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "framework/kinematics/posture.h"
#include "framework/metrology/measure.h"

namespace talus {

Points simulate_points(const Program& program, const std::vector<std::vector<double>>& poses,
                       std::uint64_t seed, double noise) {
  std::mt19937_64 random(seed ^ 0x706f696e7473);  // not the readings' numbers again
  std::normal_distribution<double> normal;
  Posture posture(program);
  Points points;
  for (const ProbedShape& s : program.shapes)
    if (s.through.empty() && s.probe.empty())
      throw InputError(s.place, fmt::format("'{}' cannot be simulated", s.name),
                       "where it is probed: at=\"frame\" probe=\"x, y, z; x, y, z; ...\"");
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (std::any_of(poses[k].begin(), poses[k].end(), [](double v) { return std::isnan(v); }))
      continue;  // a pose whose readings are not known
    posture.set(poses[k]);
    for (const ProbedShape& s : program.shapes)
      for (const Vector3<double>& p : s.probe) {
        const Eigen::Vector3d at = posture.frame(s.frame) * Eigen::Vector3d(p[0], p[1], p[2]);
        Points::Row row{0, static_cast<double>(k + 1), s.name};
        for (int i = 0; i < 3; ++i) {
          const double shaken =
              at[i] + (noise > 0 ? noise * s.sigma.value_or(0) * normal(random) : 0);
          row.at[i] = noise > 0 ? std::round(shaken * 1e6) / 1e6 : shaken;
        }
        points.rows.push_back(std::move(row));
      }
  }
  return points;
}

}  // namespace talus
