#include "framework/calibration/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "framework/calibration/circumstances.h"
#include "framework/kinematics/pose_values.h"

namespace talus {
namespace {

// What the instrument shows of a feature at T_in_at; noise in the feature's own frame for
// rotations.
std::vector<double> show(const Feature& f, PlainPose pose, const std::function<double()>& gauss) {
  const double sl = f.sigma_length.value_or(0), sa = f.sigma_angle.value_or(0);
  auto& [R, p] = pose;
  auto turned = [&, &R = R] {
    Matrix3<double> out{};
    const Rigid<double> noisy =
        Rigid<double>(R, {}) * rotate_by_vector<double>(sa * gauss(), sa * gauss(), sa * gauss());
    out = noisy.rotation();
    return out;
  };
  switch (f.kind) {
    case Kind::frame: {
      for (double& v : p) v += sl * gauss();
      const auto q = quaternion(turned());
      return {p[0], p[1], p[2], q[0], q[1], q[2], q[3]};
    }
    case Kind::point:
      for (double& v : p) v += sl * gauss();
      return {p[0], p[1], p[2]};
    case Kind::direction: {
      if (f.observed.angles) {
        std::vector<double> angles;
        for (int i = 0; i < 3; ++i)
          angles.push_back(std::acos(std::clamp(R[i][2], -1.0, 1.0)) + sa * gauss());
        return angles;
      }
      const Matrix3<double> T = turned();
      return {T[0][2], T[1][2], T[2][2]};
    }
    case Kind::scalar:
      return {std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) + sl * gauss()};
    case Kind::nothing:
      return {};
  }
  return {};
}

}  // namespace

Recordings simulate(const Program& program, const Settings& given, const SimulateOptions& options) {
  const Settings settings = with_circumstances(program, given);
  std::mt19937_64 random(options.seed);
  std::normal_distribution<double> normal;
  const std::function<double()> gauss = [&] {
    return options.noise > 0 ? options.noise * normal(random) : 0.0;
  };
  Recordings out;
  auto column = [&](const std::string& name, Dimension dimension) {
    Unit unit = program.units.of(dimension);
    if (dimension == number) unit.text.clear();  // no bracket in the header
    out.columns.push_back({name, unit, {}, {}});
  };
  column("pose", number);
  int order = -1;  // number of the covariate `pose`, where an effect needs it
  const std::size_t readings = program.readings.size();
  for (std::size_t i = 0; i < readings; ++i) {
    const Reading& r = program.readings[i];
    if (!r.covariate) column(r.column, r.dimension);
    if (r.covariate && r.column == "pose") order = static_cast<int>(i);
  }
  for (const Feature& f : program.features)
    for (int c : f.columns) column(program.columns[c].name, program.columns[c].dimension);
  std::vector<PoseValues> chains, shown;  // shown: of the features that a faulty machine measures
  for (const Feature& f : program.features) {
    chains.emplace_back(program, program.chains[f.chain].motions);
    shown.emplace_back(program, f.shown.value_or(Rigid<Expr>()));
  }
  for (std::size_t k = 0; k < settings.poses.size(); ++k) {
    std::vector<double> slots = slots_at(program, settings.poses[k]);
    std::size_t next = 0;
    out.lines.push_back(static_cast<int>(k) + 2);
    out.columns[next++].values.push_back(order < 0 ? static_cast<double>(k + 1)
                                                   : settings.poses[k][order]);
    for (std::size_t i = 0; i < readings; ++i) {
      if (program.readings[i].covariate) continue;
      out.columns[next++].values.push_back(settings.poses[k][i] +
                                           program.readings[i].sigma * gauss());
    }
    for (std::size_t f = 0; f < program.features.size(); ++f) {
      const Feature& feature = program.features[f];
      PlainPose pose = chains[f](slots);
      if (feature.shown) {
        set_chain(program.chains[feature.chain], pose, slots);
        pose = shown[f](slots);
      }
      const std::vector<double> values = show(feature, pose, gauss);
      if (values.size() != feature.columns.size())
        throw InputError(
            feature.place,
            fmt::format("feature '{}' cannot be simulated: it measures {} columns", feature.name,
                        feature.columns.size()),
            fmt::format("{} columns, as a {} has", values.size(), to_string(feature.kind)));
      for (double v : values) out.columns[next++].values.push_back(v);
    }
  }
  out.columns.insert(out.columns.begin() + 1, settings.circumstances.begin(),
                     settings.circumstances.end());
  // As many digits as an instrument shows; without noise, all of them.
  if (options.noise > 0)
    for (RecordedColumn& c : out.columns) {
      const double digits = c.unit.dimension == number ? 1e9 : 1e6;
      for (double& v : c.values)
        v = c.unit.factor * (std::round(v / c.unit.factor * digits) / digits);
    }
  return out;
}

}  // namespace talus
