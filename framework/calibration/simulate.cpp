#include "framework/calibration/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "framework/calibration/reach.h"
#include "framework/kinematics/tape_values.h"
#include "framework/model/quantity.h"

namespace talus {
namespace {

using Pose = std::pair<Matrix3<double>, Vector3<double>>;

// T_in_at of a chain at given slots.
class ChainPose {
 public:
  ChainPose(const Program& program, const Chain& chain)
      : values_(*program.tape, nodes(program, chain)) {}
  Pose operator()(std::span<const double> slots) {
    const auto& v = values_(slots);
    Pose pose;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) pose.first[i][j] = v[3 * i + j];
      pose.second[i] = v[9 + i];
    }
    return pose;
  }

 private:
  static std::vector<std::int32_t> nodes(const Program& program, const Chain& chain) {
    std::vector<std::int32_t> result;
    const Matrix3<Expr> R = chain.motions.rotation();
    const Vector3<Expr> p = chain.motions.translation();
    for (int i = 0; i < 9; ++i) result.push_back(R[i / 3][i % 3].node_on(*program.tape));
    for (int i = 0; i < 3; ++i) result.push_back(p[i].node_on(*program.tape));
    return result;
  }
  TapeValues values_;
};

std::array<double, 4> quaternion(const Matrix3<double>& R) {
  std::array<double, 4> q{};  // w x y z; the largest component first for accuracy
  const double t[4] = {R[0][0] + R[1][1] + R[2][2], R[0][0] - R[1][1] - R[2][2],
                       R[1][1] - R[0][0] - R[2][2], R[2][2] - R[0][0] - R[1][1]};
  const int k = static_cast<int>(std::max_element(t, t + 4) - t);
  const double s = 2 * std::sqrt(1 + t[k]);
  q[k] = s / 4;
  const double skew[3] = {R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1]};
  if (k == 0) {
    for (int i = 0; i < 3; ++i) q[1 + i] = skew[i] / s;
  } else {
    q[0] = skew[k - 1] / s;
    for (int i = 0; i < 3; ++i)
      if (i != k - 1) q[1 + i] = (R[k - 1][i] + R[i][k - 1]) / s;
  }
  if (q[0] < 0)
    for (double& v : q) v = -v;
  return q;
}

// What the instrument shows of a feature at T_in_at; noise in the feature's own frame for
// rotations.
std::vector<double> show(const Feature& f, Pose pose, const std::function<double()>& gauss) {
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

namespace {

// What moves from pose to pose: readings, then unknowns.
struct Coordinate {
  std::string name, column;
  Dimension dimension;
  double rest;
  std::optional<std::pair<double, double>> range;
};

std::vector<Coordinate> coordinates(const Program& program) {
  std::vector<Coordinate> list;
  const std::pair<double, double> turn(-60 * deg, 60 * deg);
  for (const Reading& r : program.readings) {
    list.push_back({r.sensor, r.column, r.dimension, 0, r.range});
    if (!r.range && r.dimension == angle) list.back().range = turn;
  }
  for (const Unknown& u : program.unknowns) {
    list.push_back({u.name, u.name, u.dimension, u.start.value, {}});
    if (!u.per.empty()) continue;
    if (u.start.bounds && std::isfinite(u.start.bounds->first) &&
        std::isfinite(u.start.bounds->second))
      list.back().range = u.start.bounds;
    else if (u.dimension == angle)
      list.back().range = turn;
  }
  return list;
}

std::vector<std::string> words_of(const std::string& text, char separator) {
  std::vector<std::string> words{""};
  for (char c : text) {
    if (c == separator)
      words.emplace_back();
    else
      words.back() += c;
  }
  return words;
}

}  // namespace

Settings random_settings(const Program& program, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::vector<Coordinate> list = coordinates(program);
  Settings settings;
  for (int k = 0; k < count; ++k) {
    auto& pose = settings.poses.emplace_back();
    for (const Coordinate& c : list)
      pose.push_back(c.range ? std::uniform_real_distribution<double>(
                                   c.range->first, std::nextafter(c.range->second, 1e300))(random)
                             : c.rest);
  }
  return settings;
}

Settings grid_settings(const Program& program, const std::string& grid) {
  const std::vector<Coordinate> list = coordinates(program);
  std::vector<std::string> names;
  std::vector<std::vector<double>> axes;
  for (const Coordinate& c : list) names.push_back(c.name), axes.push_back({c.rest});
  const Place place{"--grid", 0, 0};
  for (const std::string& part : words_of(grid, ';')) {
    const std::size_t equals = part.find('=');
    std::string name = part.substr(0, equals);
    std::erase(name, ' ');
    if (name.empty() && equals == std::string::npos) continue;
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end() || equals == std::string::npos)
      throw InputError(place, fmt::format("'{}'", part),
                       "name=first:last:step or name=a,b,c with one of: " + join(names),
                       nearest(name, names));
    const Coordinate& c = list[it - names.begin()];
    auto value = [&](const std::string& text) {
      return parse_quantity(text, c.dimension, program.units, place).value;
    };
    const std::string values = part.substr(equals + 1);
    auto& axis = axes[it - names.begin()];
    axis.clear();
    if (values.find(':') == std::string::npos) {
      for (const std::string& w : words_of(values, ',')) axis.push_back(value(w));
      continue;
    }
    const std::vector<std::string> words = words_of(values, ':');
    if (words.size() != 3) throw InputError(place, fmt::format("'{}'", values), "first:last:step");
    const double first = value(words[0]), last = value(words[1]), step = value(words[2]);
    if (!(step > 0) || last < first)
      throw InputError(place, fmt::format("'{}'", values),
                       "first below last, and a step above zero");
    const double count = std::floor((last - first) / step + 1e-9);
    if (count > 1e6)
      throw InputError(place, fmt::format("'{}' makes {:.3g} values", values, count + 1),
                       "at most a million");
    for (int i = 0; i <= static_cast<int>(count); ++i) axis.push_back(first + i * step);
  }
  Settings settings{{{}}};
  double size = 1;
  for (const auto& axis : axes) size *= static_cast<double>(axis.size());
  if (size > 1e6) throw InputError(place, fmt::format("{:.3g} poses", size), "at most a million");
  for (const auto& axis : axes) {
    std::vector<std::vector<double>> next;
    for (const auto& pose : settings.poses)
      for (double v : axis) {
        next.push_back(pose);
        next.back().push_back(v);
      }
    settings.poses = std::move(next);
  }
  return settings;
}

Settings settings_from(Program& program, const Recordings& recordings, int threads) {
  const bool given = std::all_of(program.readings.begin(), program.readings.end(),
                                 [&](const Reading& r) { return recordings.find(r.column); });
  Settings settings;
  if (given) {
    for (std::size_t k = 0; k < recordings.rows(); ++k) {
      auto& pose = settings.poses.emplace_back();
      for (const Coordinate& c : coordinates(program))
        pose.push_back(recordings.find(c.column) ? recordings.get(c.column, c.dimension).values[k]
                                                 : c.rest);
    }
    return settings;
  }
  const Reached reached = reach(program, recordings, threads);
  settings.poses = reached.readings;
  for (std::size_t k = 0; k < recordings.rows(); ++k) {
    if (reached.how[k] == Reached::How::not_at_all)
      throw InputError({recordings.file, recordings.lines[k], 0},
                       "this pose cannot be reached by the linkage");
    // The model's own unknowns stay at their start.
    for (const Unknown& u : program.unknowns) settings.poses[k].push_back(u.start.value);
  }
  return settings;
}

Recordings simulate(const Program& program, const Settings& settings,
                    const SimulateOptions& options) {
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
  for (const Reading& r : program.readings) column(r.column, r.dimension);
  for (const Feature& f : program.features)
    for (int c : f.columns) column(program.columns[c].name, program.columns[c].dimension);
  std::vector<ChainPose> chains;
  for (const Feature& f : program.features) chains.emplace_back(program, program.chains[f.chain]);
  std::vector<double> slots(program.slots, 0);
  for (const Parameter& p : program.parameters) slots[p.slot] = p.nominal.value;
  const std::size_t readings = program.readings.size();
  for (std::size_t k = 0; k < settings.poses.size(); ++k) {
    for (std::size_t u = 0; u < program.unknowns.size(); ++u)
      slots[program.unknowns[u].slot] = settings.poses[k][readings + u];
    std::size_t next = 0;
    out.lines.push_back(static_cast<int>(k) + 2);
    out.columns[next++].values.push_back(static_cast<double>(k + 1));
    for (std::size_t i = 0; i < readings; ++i) {
      slots[program.readings[i].slot] = settings.poses[k][i];
      out.columns[next++].values.push_back(settings.poses[k][i] +
                                           program.readings[i].sigma * gauss());
    }
    for (std::size_t f = 0; f < program.features.size(); ++f) {
      const std::vector<double> shown = show(program.features[f], chains[f](slots), gauss);
      if (shown.size() != program.features[f].columns.size())
        throw InputError(program.features[f].place,
                         fmt::format("feature '{}' cannot be simulated: it measures {} columns",
                                     program.features[f].name, program.features[f].columns.size()),
                         fmt::format("{} columns, as a {} has", shown.size(),
                                     to_string(program.features[f].kind)));
      for (double v : shown) out.columns[next++].values.push_back(v);
    }
  }
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
