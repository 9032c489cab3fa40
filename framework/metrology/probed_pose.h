// The shapes and datums of one pose, worked out from its probed points.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "framework/metrology/datum.h"
#include "framework/recordings/points.h"

namespace talus {

// The probed points of one pose, by shape, in the order probed.
using PointsOfPose = std::vector<std::vector<const Points::Row*>>;

// Sorted by pose. InputError for points of no shape, of shapes that have none of their own, and for
// one that is given twice.
std::map<double, PointsOfPose> by_pose(const Program& program, const Points& points);

// Shapes whose axis something follows: a datum, or a measured direction.
std::vector<bool> axes_that_count(const Program& program);

class ProbedPose {
 public:
  // InputError, with the line of the first point: too few points, points that fix no shape or two,
  // or whose order does not tell the sense of an axis that counts.
  ProbedPose(const Program& program, const std::vector<ShapeFitter>& fitters,
             const std::vector<bool>& axis_counts, const PointsOfPose& points,
             const std::string& file);

  // What the feature's columns would show; nothing where points are missing.
  std::optional<DerivedColumns> columns(const Feature& feature) const;
  const FittedShape* shape(std::size_t s) const { return known_[s] ? &shapes_[s] : nullptr; }
  // The shape to which each raw coordinate belongs, and where its point stands in the file.
  const std::vector<int>& owner() const { return owner_; }
  // How far from square each datum's shapes are, rad; NaN where it could not be made.
  const std::vector<double>& squares() const { return squares_; }
  Place place(std::size_t shape) const { return places_[shape]; }

 private:
  void fit(std::size_t s, const ShapeFitter& fitter, bool axis_counts,
           const std::vector<Derived>& points);
  const Derived& centre(int shape, const Place& of) const;  // InputError where it has none

  const Program& program_;
  std::vector<FittedShape> shapes_;
  std::vector<bool> known_;
  std::vector<Place> places_;
  std::vector<std::optional<DerivedFrame>> datums_;
  std::vector<int> owner_;
  std::vector<double> squares_;
};

}  // namespace talus
