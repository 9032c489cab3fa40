#include "framework/metrology/probed_pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace talus {

std::map<double, PointsOfPose> by_pose(const Program& program, const Points& points) {
  std::vector<std::string> names;
  for (const ProbedShape& s : program.shapes) names.push_back(s.name);
  std::map<double, PointsOfPose> result;
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
    PointsOfPose& pose = result[row.pose];
    pose.resize(names.size());
    for (const Points::Row* other : pose[s])
      if (other->at == row.at)
        throw InputError(place,
                         fmt::format("the same point of '{}' at pose {:g} as in line {}",
                                     row.feature, row.pose, other->line),
                         "each point once");
    pose[s].push_back(&row);
  }
  return result;
}

std::vector<bool> axes_that_count(const Program& program) {
  std::vector<bool> counts(program.shapes.size(), false);
  for (const Datum& d : program.datums)
    for (const Datum::Axis& axis : d.axes) counts[axis.shape] = true;
  for (const Feature& f : program.features)
    if (f.kind == Kind::direction && f.probed.shape >= 0) counts[f.probed.shape] = true;
  return counts;
}

ProbedPose::ProbedPose(const Program& program, const std::vector<ShapeFitter>& fitters,
                       const std::vector<bool>& axis_counts, const PointsOfPose& points,
                       const std::string& file)
    : program_(program), shapes_(program.shapes.size()), known_(program.shapes.size(), false) {
  Eigen::Index raw = 0, next = 0;
  for (const auto& list : points) raw += 3 * static_cast<Eigen::Index>(list.size());
  for (std::size_t s = 0; s < program.shapes.size(); ++s) {
    const ProbedShape& shape = program.shapes[s];
    places_.push_back({file, points[s].empty() ? 0 : points[s][0]->line, 0});
    std::vector<Derived> at;
    for (const Points::Row* row : points[s]) {
      Derived p{{row->at[0], row->at[1], row->at[2]}, Eigen::Matrix3Xd::Zero(3, raw)};
      p.by.middleCols<3>(next).setIdentity();
      next += 3;
      owner_.insert(owner_.end(), 3, static_cast<int>(s));
      at.push_back(std::move(p));
    }
    bool whole = shape.on < 0 || known_[shape.on];
    for (int other : shape.through) {
      whole = whole && known_[other];
      if (whole) at.push_back(centre(other, shape.place));
    }
    if (at.empty() || !whole) continue;
    if (shape.on >= 0) at = projected(at, shapes_[shape.on]);
    fit(s, fitters[s], axis_counts[s], at);
  }
  for (const Datum& d : program.datums) {
    bool whole = true;
    for (int s : d.origin) whole = whole && known_[s];
    for (const auto& axis : d.axes) whole = whole && known_[axis.shape];
    double square = 0;
    datums_.push_back(whole ? std::optional(frame_of(d, shapes_, square)) : std::nullopt);
    squares_.push_back(whole ? square : std::numeric_limits<double>::quiet_NaN());
  }
}

void ProbedPose::fit(std::size_t s, const ShapeFitter& fitter, bool axis_counts,
                     const std::vector<Derived>& points) {
  const ProbedShape& shape = program_.shapes[s];
  const Place& place = places_[s];
  const int fewest = shape.declaration.points - (shape.radius && shape.declaration.points > 3);
  if (static_cast<int>(points.size()) < fewest)
    throw InputError(place,
                     fmt::format("'{}' has {} point{}", shape.name, points.size(),
                                 points.size() == 1 ? "" : "s"),
                     fmt::format("{} or more: it is a {}", fewest, shape.tag));
  FittedShape& fitted = shapes_[s] = fitter.fit(points);
  const std::string of = fmt::format("the points of '{}'", shape.name);
  if (!fitted.determined)
    throw InputError(place, fmt::format("{} do not determine a {}", of, shape.tag),
                     "points that are spread over it");
  if (fitted.ambiguous)
    throw InputError(place, fmt::format("{} fit two different {}s equally well", of, shape.tag),
                     "points that tell them apart (rings of points turned against each other, more "
                     "of the surface), a known radius=\"...\", and no blunder among them");
  if (axis_counts && fitted.sense < 0.2)
    throw InputError(place, of + " stand in an order that does not tell which way its axis points",
                     shape.declaration.sense == Sense::along
                         ? "points from one end to the other"
                         : "points in turn around the axis, right-handed");
  known_[s] = true;
}

const Derived& ProbedPose::centre(int shape, const Place& of) const {
  if (shapes_[shape].held.trace() < 2.5)
    throw InputError(of,
                     fmt::format("'{}' is a {}, which has no centre", program_.shapes[shape].name,
                                 program_.shapes[shape].tag),
                     "a circle or a sphere");
  return shapes_[shape].origin;
}

std::optional<DerivedColumns> ProbedPose::columns(const Feature& f) const {
  const DerivedFrame* in = nullptr;
  if (f.probed.in >= 0) {
    if (!datums_[f.probed.in]) return {};
    in = &*datums_[f.probed.in];
  }
  if (f.probed.shape >= 0) {
    if (!known_[f.probed.shape]) return {};
    if (f.kind != Kind::direction) centre(f.probed.shape, f.place);
    return columns_of(f, shapes_[f.probed.shape], in);
  }
  const auto& datum = datums_[f.probed.datum];
  if (!datum) return {};
  return columns_of(f, in ? seen_from(*in, *datum) : *datum);
}

}  // namespace talus
