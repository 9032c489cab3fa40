#include "framework/metrology/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "framework/kinematics/posture.h"
#include "framework/metrology/datum.h"

namespace talus {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// The probed points of one pose, by shape, in the order probed.
using OfPose = std::vector<std::vector<const Points::Row*>>;

std::map<double, OfPose> by_pose(const Program& program, const Points& points) {
  std::vector<std::string> names;
  for (const ProbedShape& s : program.shapes) names.push_back(s.name);
  std::map<double, OfPose> result;
  for (const Points::Row& row : points.rows) {
    const auto it = std::find(names.begin(), names.end(), row.feature);
    const Place place{points.file, row.line, 0};
    if (it == names.end())
      throw InputError(place, fmt::format("no probed shape '{}' in the model", row.feature),
                       "one of: " + join(names), nearest(row.feature, names));
    const auto s = static_cast<std::size_t>(it - names.begin());
    if (!program.shapes[s].through.empty())
      throw InputError(
          place,
          fmt::format("'{}' goes through other shapes and has no points of its own", row.feature),
          "points of the shapes that it goes through");
    OfPose& pose = result[row.pose];
    pose.resize(names.size());
    pose[s].push_back(&row);
  }
  return result;
}

class Pose {
 public:
  Pose(const Program& program, const std::vector<ShapeFitter>& fitters, const OfPose& points,
       const std::string& file)
      : program_(program), shapes_(program.shapes.size()), known_(program.shapes.size(), false) {
    for (const auto& list : points) raw_ += 3 * static_cast<Eigen::Index>(list.size());
    Eigen::Index next = 0;
    for (std::size_t s = 0; s < program.shapes.size(); ++s) {
      const ProbedShape& shape = program.shapes[s];
      std::vector<Derived> at;
      for (const Points::Row* row : points[s]) {
        Derived p{{row->at[0], row->at[1], row->at[2]}, Eigen::Matrix3Xd::Zero(3, raw_)};
        p.by.middleCols<3>(next).setIdentity();
        next += 3;
        owner.insert(owner.end(), 3, static_cast<int>(s));
        at.push_back(std::move(p));
      }
      bool whole = true;
      for (int other : shape.through) {
        whole &= known_[other];
        at.push_back(shapes_[other].origin);
      }
      if (shape.on >= 0) {
        whole &= known_[shape.on];
        if (whole) at = projected(at, shapes_[shape.on]);
      }
      if (at.empty() || !whole) continue;
      const Place place{file, points[s].empty() ? 0 : points[s][0]->line, 0};
      const int fewest = shape.declaration.points - (shape.radius && shape.declaration.points > 3);
      if (static_cast<int>(at.size()) < fewest)
        throw InputError(
            place,
            fmt::format("'{}' has {} point{}", shape.name, at.size(), at.size() == 1 ? "" : "s"),
            fmt::format("{} or more: it is a {}", fewest, shape.tag));
      shapes_[s] = fitters[s].fit(at);
      if (!shapes_[s].determined)
        throw InputError(
            place, fmt::format("the points of '{}' do not determine a {}", shape.name, shape.tag),
            "points that are spread over it");
      if (shapes_[s].ambiguous)
        throw InputError(
            place,
            fmt::format("the points of '{}' lie on two different {}s", shape.name, shape.tag),
            "points that tell them apart (two rings of points, one turned against the "
            "other)");
      known_[s] = true;
    }
    for (const Datum& d : program.datums) {
      bool whole = true;
      for (int s : d.origin) whole &= known_[s];
      for (const auto& axis : d.axes) whole &= known_[axis.shape];
      double square = 0;
      datums_.push_back(whole ? std::optional(frame_of(d, shapes_, square)) : std::nullopt);
      squares.push_back(whole ? square : nan);
    }
  }

  std::optional<DerivedColumns> columns(const Feature& f) const {
    const DerivedFrame* in = nullptr;
    if (f.probed.in >= 0) {
      if (!datums_[f.probed.in]) return {};
      in = &*datums_[f.probed.in];
    }
    if (f.probed.shape >= 0)
      return known_[f.probed.shape] ? std::optional(columns_of(f, shapes_[f.probed.shape], in))
                                    : std::nullopt;
    const auto& datum = datums_[f.probed.datum];
    if (!datum) return {};
    return columns_of(f, in ? seen_from(*in, *datum) : *datum);
  }
  const FittedShape* shape(std::size_t s) const { return known_[s] ? &shapes_[s] : nullptr; }

  std::vector<int> owner;       // the shape of each raw coordinate
  std::vector<double> squares;  // of each datum, rad; NaN where it could not be made

 private:
  const Program& program_;
  std::vector<FittedShape> shapes_;
  std::vector<bool> known_;
  std::vector<std::optional<DerivedFrame>> datums_;
  Eigen::Index raw_ = 0;
};

// The standard deviation of a probed point: stated, or from what the fits of all poses leave over.
std::vector<ShapeQuality> qualities(const Program& program, const std::vector<Pose>& poses,
                                    const std::vector<double>& numbers) {
  std::vector<ShapeQuality> result;
  double all_squares = 0;
  int all_surplus = 0;
  for (std::size_t s = 0; s < program.shapes.size(); ++s) {
    const ProbedShape& shape = program.shapes[s];
    ShapeQuality q{shape.name, shape.tag};
    double squares = 0;
    int surplus = 0;
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const FittedShape* fitted = poses[k].shape(s);
      if (!fitted) continue;
      ++q.poses;
      q.points += fitted->points;
      squares += fitted->squares;
      // Deviations out of the plane that the points were projected on are no deviations.
      surplus += fitted->deviations - fitted->freedom - (shape.on >= 0 ? fitted->points - 3 : 0);
      const double rmse = std::sqrt(fitted->squares / fitted->points);
      if (rmse > q.worst) q.worst = rmse, q.worst_pose = numbers[k];
    }
    if (q.points > 0) q.rmse = std::sqrt(squares / static_cast<double>(q.points));
    q.sigma = shape.sigma ? *shape.sigma : surplus > 0 ? std::sqrt(squares / surplus) : nan;
    if (surplus > 0 && shape.through.empty()) all_squares += squares, all_surplus += surplus;
    result.push_back(q);
  }
  for (std::size_t s = 0; s < result.size(); ++s)
    if (std::isnan(result[s].sigma) && all_surplus > 0)
      result[s].sigma = std::sqrt(all_squares / all_surplus);
  return result;
}

}  // namespace

bool is_probed(const Program& program) {
  return std::any_of(program.features.begin(), program.features.end(),
                     [](const Feature& f) { return bool(f.probed); });
}

Measured measure(const Program& program, Recordings recordings, const Points& points) {
  const RecordedColumn& numbers = recordings.get("pose", number);
  const std::map<double, OfPose> table = by_pose(program, points);
  for (const auto& [pose, lists] : table)
    if (std::find(numbers.values.begin(), numbers.values.end(), pose) == numbers.values.end())
      for (const auto& list : lists)
        for (const Points::Row* row : list)
          throw InputError({points.file, row->line, 0}, fmt::format("pose {:g}", pose),
                           fmt::format("a pose that '{}' has", recordings.file));
  const std::vector<ShapeFitter> fitters(program.shapes.begin(), program.shapes.end());
  const OfPose none(program.shapes.size());
  std::vector<Pose> poses;
  for (double pose : numbers.values) {
    const auto it = table.find(pose);
    poses.emplace_back(program, fitters, it == table.end() ? none : it->second, points.file);
  }

  Measured out;
  out.shapes = qualities(program, poses, numbers.values);
  for (std::size_t d = 0; d < program.datums.size(); ++d) {
    DatumQuality q{program.datums[d].name};
    for (std::size_t k = 0; k < poses.size(); ++k)
      if (poses[k].squares[d] > q.worst)
        q.worst = poses[k].squares[d], q.worst_pose = numbers.values[k];
    if (const auto& limit = program.datums[d].square; limit && q.worst > *limit)
      out.warnings.push_back(
          fmt::format("The shapes of datum '{}' are up to {:.3g} deg from square (pose {:g}), more "
                      "than the {:.3g} deg allowed.",
                      q.name, q.worst / deg, q.worst_pose, *limit / deg));
    out.datums.push_back(q);
  }

  MeasuredNoise noise;
  noise.covariance.resize(poses.size());
  std::vector<std::vector<double>> values(poses.size());
  for (const Feature& f : program.features) {
    if (!f.probed) continue;
    for (int c : f.columns) {
      const MeasuredColumn& column = program.columns[c];
      if (recordings.find(column.name)) {
        std::erase_if(recordings.columns, [&](const auto& r) { return r.name == column.name; });
        out.warnings.push_back(fmt::format(
            "The column '{}' of the recordings is not used: the points give it.", column.name));
      }
      noise.columns.push_back(column.name);
      Unit unit = program.units.of(column.dimension);
      if (column.dimension == number) unit.text.clear();
      recordings.columns.push_back({column.name, unit, std::vector<double>(poses.size(), nan), {}});
    }
  }
  const auto n = static_cast<Eigen::Index>(noise.columns.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const auto raw = static_cast<Eigen::Index>(poses[k].owner.size());
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, raw);
    Eigen::Index next = 0;
    auto column = recordings.columns.end() - n;
    for (const Feature& f : program.features) {
      if (!f.probed) continue;
      if (const auto found = poses[k].columns(f)) {
        if (found->values.size() != f.columns.size())
          throw InputError(f.place, fmt::format("feature '{}' cannot be probed", f.name),
                           "frame, point, direction, direction_angles or length");
        for (std::size_t i = 0; i < found->values.size(); ++i)
          column[next + static_cast<Eigen::Index>(i)].values[k] = found->values[i];
        C.middleRows(next, found->by.rows()) = found->by;
      }
      next += static_cast<Eigen::Index>(f.columns.size());
    }
    Eigen::VectorXd sigma(raw);
    for (Eigen::Index i = 0; i < raw; ++i) {
      const ShapeQuality& q = out.shapes[poses[k].owner[i]];
      sigma[i] = q.sigma;
      if (std::isnan(sigma[i]) && !program.settings.weighted)
        throw InputError(
            program.shapes[poses[k].owner[i]].place,
            fmt::format("the points of '{}' leave nothing to tell their noise by", q.name),
            "its sigma=\"...\": standard deviation of a probed point");
      if (std::isnan(sigma[i])) sigma[i] = 0;
    }
    const Eigen::MatrixXd S = C * sigma.cwiseAbs2().asDiagonal() * C.transpose();
    noise.covariance[k].assign(S.data(), S.data() + S.size());
  }
  recordings.noise = std::move(noise);
  out.recordings = std::move(recordings);
  return out;
}

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
