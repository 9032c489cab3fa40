// From the raw points of a coordinate measuring machine to measured features: shapes are fitted,
// datums made of them, and the features that a model calls `probed` become columns of the
// recordings, as if the machine had given them, with their covariance (from the points' noise,
// first order).
#pragma once

#include <string>
#include <vector>

#include "framework/kinematics/program.h"
#include "framework/recordings/points.h"
#include "framework/recordings/recordings.h"

namespace talus {

// How well a shape fits its points, over all poses.
struct ShapeQuality {
  std::string name, tag;
  std::size_t poses = 0, points = 0;
  double rmse = 0;   // mm, over all points
  double worst = 0;  // mm, the largest rmse of one pose
  double worst_pose = 0;
  double sigma = 0;  // mm, of a point: stated, or from what the fits leave; NaN where unknown
};

// How square the shapes are of which a datum is made.
struct DatumQuality {
  std::string name;
  double worst = 0;  // rad: largest departure from a right angle of the shapes' axes; NaN: one axis
  double worst_pose = 0;
};

struct Measured {
  Recordings recordings;
  std::string points_file;  // empty: nothing was probed
  std::vector<ShapeQuality> shapes;
  std::vector<DatumQuality> datums;
  std::vector<std::string> warnings;  // whole sentences
};

// Is any feature of the model probed?
bool is_probed(const Program& program);

// Adds the probed features' columns to `recordings`, whose column `pose` says which points belong
// to a row. InputError for: points of no shape or no row, too few points or such as do not
// determine their shape, no noise to be had.
Measured measure(const Program& program, Recordings recordings, const Points& points);

// The probed points of simulated poses (as Settings::poses) in the axes of the root frame, with the
// shapes' sigmas as noise; the order of `poses` gives the pose numbers 1, 2, ...
Points simulate_points(const Program& program, const std::vector<std::vector<double>>& poses,
                       std::uint64_t seed, double noise);

}  // namespace talus
