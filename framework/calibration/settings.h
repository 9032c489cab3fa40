// Where a linkage is to go: the values of everything that moves from pose to pose, drawn at random
// or on a grid. From a table they come by inverse.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

// What moves from pose to pose: the program's readings, then its unknowns.
struct Coordinate {
  std::string name, column;  // the sensor and its column; the unknown, twice
  Dimension dimension;
  double rest;  // zero, or the middle of the range where zero is outside; the unknown's start; a
                // covariate's usual value
  std::optional<std::pair<double, double>> range;
  bool covariate = false;  // a circumstance that effects depend on; it moves nothing by itself
};
std::vector<Coordinate> coordinates(const Program& program);

// One value per coordinate (internal units), in that order.
struct Settings {
  std::vector<std::vector<double>> poses;  // [pose][coordinate]
  // What is recorded beside the readings; see circumstances.h.
  std::vector<RecordedColumn> circumstances = {};
};

// `count` poses drawn uniformly from the sensors' ranges and the bounds of unknowns per pose;
// without these an angle is drawn from -60 to 60 deg and anything else stays at its start.
Settings random_settings(const Program& program, int count, std::uint64_t seed);
// "encoder1=-20:20:10; q1=0,30,60": every combination; what is not named rests.
Settings grid_settings(const Program& program, const std::string& grid);

}  // namespace talus
