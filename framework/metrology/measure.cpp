#include "framework/metrology/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/metrology/probed_pose.h"

namespace talus {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Of each row, which must be told apart by them.
const std::vector<double>& pose_numbers(const Recordings& recordings) {
  const std::vector<double>& numbers = recordings.get("pose", number).values;
  std::map<double, int> lines;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const Place place{recordings.file, recordings.lines[k], 0};
    if (std::isnan(numbers[k]))
      throw InputError(place, "column 'pose' is empty", "the number by which its points are found");
    const auto [it, fresh] = lines.emplace(numbers[k], recordings.lines[k]);
    if (!fresh)
      throw InputError(place, fmt::format("pose {:g} again, as in line {}", numbers[k], it->second),
                       "a number for each row: its points are found by it");
  }
  return numbers;
}

void check_poses(const std::map<double, PointsOfPose>& table, const std::vector<double>& numbers,
                 const Points& points, const Recordings& recordings) {
  for (const auto& [pose, lists] : table)
    if (std::find(numbers.begin(), numbers.end(), pose) == numbers.end())
      for (const auto& list : lists)
        for (const Points::Row* row : list)
          throw InputError({points.file, row->line, 0}, fmt::format("pose {:g}", pose),
                           fmt::format("a pose that '{}' has", recordings.file));
}

// How well each shape fits. The standard deviation of a probed point is the one stated, or what the
// fits of all poses leave; of shapes without a point to spare, what all others leave.
std::vector<ShapeQuality> qualities(const Program& program, const std::vector<ProbedPose>& poses,
                                    const std::vector<double>& numbers,
                                    std::vector<std::string>& warnings) {
  std::vector<ShapeQuality> result;
  double all_squares = 0;
  int all_surplus = 0;
  for (std::size_t s = 0; s < program.shapes.size(); ++s) {
    const ProbedShape& shape = program.shapes[s];
    ShapeQuality q{shape.name, shape.tag};
    double squares = 0, farthest = 0;  // of one pose, by the points to spare
    int surplus = 0;
    Place worst;
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const FittedShape* fitted = poses[k].shape(s);
      if (!fitted) continue;
      ++q.poses;
      q.points += fitted->points;
      squares += fitted->squares;
      surplus += fitted->surplus;
      const double rmse = std::sqrt(fitted->squares / fitted->points);
      if (rmse >= q.worst) q.worst = rmse, q.worst_pose = numbers[k], worst = poses[k].place(s);
      if (fitted->surplus > 0)
        farthest = std::max(farthest, std::sqrt(fitted->squares / fitted->surplus));
    }
    if (q.poses < poses.size())
      warnings.push_back(
          fmt::format("'{}' is not probed at {} of {} poses; what is measured by it "
                      "is missing there.",
                      q.name, poses.size() - q.poses, poses.size()));
    if (q.points > 0) q.rmse = std::sqrt(squares / static_cast<double>(q.points));
    const double left = surplus > 0 ? std::sqrt(squares / surplus) : nan;
    q.sigma = shape.sigma.value_or(left);
    if (left > 3 * q.sigma || farthest > 6 * q.sigma)
      warnings.push_back(fmt::format(
          "The points of '{}' are off the {} that fits them by {:.0f} times {} over all poses, by "
          "{:.0f} "
          "times at pose {:g} ({}). A blunder, a wrong unit, a form error, or a sigma too small.",
          q.name, q.tag, left / q.sigma, shape.sigma ? "their stated sigma" : "their usual noise",
          farthest / q.sigma, q.worst_pose, to_string(worst)));
    if (surplus > 0 && shape.through.empty()) all_squares += squares, all_surplus += surplus;
    result.push_back(q);
  }
  for (ShapeQuality& q : result)
    if (std::isnan(q.sigma) && all_surplus > 0) q.sigma = std::sqrt(all_squares / all_surplus);
  return result;
}

std::vector<DatumQuality> squareness(const Program& program, const std::vector<ProbedPose>& poses,
                                     const std::vector<double>& numbers,
                                     std::vector<std::string>& warnings) {
  std::vector<DatumQuality> result;
  for (std::size_t d = 0; d < program.datums.size(); ++d) {
    const Datum& datum = program.datums[d];
    DatumQuality q{datum.name, nan};
    for (std::size_t k = 0; k < poses.size() && datum.axes.size() > 1; ++k)
      if (!std::isnan(poses[k].squares()[d]) && !(poses[k].squares()[d] <= q.worst))
        q.worst = poses[k].squares()[d], q.worst_pose = numbers[k];
    if (datum.square && q.worst > *datum.square)
      warnings.push_back(
          fmt::format("The shapes of datum '{}' are up to {:.3g} deg from square (pose {:g}), more "
                      "than the {:.3g} deg allowed.",
                      q.name, q.worst / deg, q.worst_pose, *datum.square / deg));
    result.push_back(q);
  }
  return result;
}

// Standard deviation of each raw coordinate of a pose.
Eigen::VectorXd sigmas(const Program& program, const ProbedPose& pose,
                       const std::vector<ShapeQuality>& shapes) {
  Eigen::VectorXd sigma(static_cast<Eigen::Index>(pose.owner().size()));
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    const int s = pose.owner()[i];
    sigma[i] = shapes[s].sigma;
    if (std::isnan(sigma[i]) && !program.settings.weighted)
      throw InputError(
          program.shapes[s].place,
          fmt::format("the points of '{}' leave nothing to tell their noise by", shapes[s].name),
          "its sigma=\"...\": standard deviation of a probed point");
    if (std::isnan(sigma[i])) sigma[i] = 0;
  }
  return sigma;
}

// An axis that counts must be known to a few degrees, or its sense and all that hangs on it is
// chance.
void check_axes(const Program& program, const ProbedPose& pose, const std::vector<bool>& counts,
                const Eigen::VectorXd& sigma) {
  for (std::size_t s = 0; s < program.shapes.size(); ++s)
    if (const FittedShape* shape = pose.shape(s); shape && counts[s]) {
      const double std = (shape->axis.by * sigma.asDiagonal()).norm();
      if (std > 5 * deg)
        throw InputError(pose.place(s),
                         fmt::format("the points of '{}' tell its axis to {:.2g} deg only",
                                     program.shapes[s].name, std / deg),
                         "points spread more widely over it (better than 5 deg)");
    }
}

}  // namespace

bool is_probed(const Program& program) {
  return std::any_of(program.features.begin(), program.features.end(),
                     [](const Feature& f) { return bool(f.probed); });
}

Measured measure(const Program& program, Recordings recordings, const Points& points) {
  const std::vector<double> numbers = pose_numbers(recordings);
  const std::map<double, PointsOfPose> table = by_pose(program, points);
  check_poses(table, numbers, points, recordings);
  const std::vector<ShapeFitter> fitters(program.shapes.begin(), program.shapes.end());
  const std::vector<bool> counts = axes_that_count(program);
  const PointsOfPose none(program.shapes.size());
  std::vector<ProbedPose> poses;
  for (double pose : numbers) {
    const auto it = table.find(pose);
    poses.emplace_back(program, fitters, counts, it == table.end() ? none : it->second,
                       points.file);
  }

  Measured out;
  out.points_file = points.file;
  out.shapes = qualities(program, poses, numbers, out.warnings);
  for (const ShapeQuality& q : out.shapes)
    if (q.poses == 0)
      throw InputError({points.file, 0, 0}, fmt::format("there are no points of '{}'", q.name),
                       "points of all shapes: " + join([&] {
                         std::vector<std::string> names;
                         for (const ShapeQuality& shape : out.shapes) names.push_back(shape.name);
                         return names;
                       }()));
  out.datums = squareness(program, poses, numbers, out.warnings);

  MeasuredNoise& noise = recordings.noise = {};
  noise.covariance.resize(poses.size());
  for (const Feature& f : program.features) {
    if (!f.probed) continue;
    bool displaced = false;
    for (int c : f.columns) {
      const MeasuredColumn& column = program.columns[c];
      displaced |= std::erase_if(recordings.columns,
                                 [&](const auto& r) { return r.name == column.name; }) > 0;
      noise.columns.push_back(column.name);
      Unit unit = program.units.of(column.dimension);
      if (column.dimension == number) unit.text.clear();
      recordings.columns.push_back({column.name, unit, std::vector<double>(poses.size(), nan), {}});
    }
    if (displaced)
      out.warnings.push_back(
          fmt::format("The recorded columns of '{}' are not used: the points of '{}' give them.",
                      f.name, points.file));
  }
  const auto n = static_cast<Eigen::Index>(noise.columns.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Eigen::VectorXd sigma = sigmas(program, poses[k], out.shapes);
    check_axes(program, poses[k], counts, sigma);
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, sigma.size());
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
    const Eigen::MatrixXd S = C * sigma.cwiseAbs2().asDiagonal() * C.transpose();
    noise.covariance[k].assign(S.data(), S.data() + S.size());
  }
  out.recordings = std::move(recordings);
  return out;
}

}  // namespace talus
