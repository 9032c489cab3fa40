// Recordings from a model: where the readings are given, the measured features follow by forward
// kinematics; where the measured features are given, the readings follow by inverse kinematics,
// which is the same problem with the readings as unknowns of their pose. Noise comes from the
// sensors' and features' sigmas.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

struct SimulateOptions {
  std::uint64_t seed = 1;
  double noise = 1;  // times the stated sigmas
  int threads = 1;
};

// Where to go: one value per coordinate (internal units), the program's readings, then its
// unknowns.
struct Settings {
  std::vector<std::vector<double>> poses;  // [pose][coordinate]
};

// `count` poses drawn uniformly from the sensors' ranges and the bounds of unknowns per pose;
// without these an angle is drawn from -60 to 60 deg and anything else stays at its start.
Settings random_settings(const Program& program, int count, std::uint64_t seed);
// "encoder1=-20:20:10; q1=0,30,60": every combination; what is not named stays at zero or its
// start.
Settings grid_settings(const Program& program, const std::string& grid);
// The readings of a table (and unknowns, where it has columns of their names), or the readings that
// reach its measured features. InputError names a pose that cannot be reached.
Settings settings_from(Program& program, const Recordings& recordings, int threads);

Recordings simulate(const Program& program, const Settings& settings,
                    const SimulateOptions& options);

}  // namespace talus
