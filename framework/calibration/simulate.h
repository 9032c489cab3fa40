// Recordings from a model: where the coordinates are given (settings.h) the measured features
// follow by forward kinematics. Where the measured features are given, the coordinates follow by
// inverse kinematics (inverse.h). Noise comes from the sensors' and features' sigmas. Effects of
// the model act; the circumstances that they need are made up where the settings lack them
// (circumstances.h).
#pragma once

#include <cstdint>

#include "framework/calibration/inverse.h"
#include "framework/calibration/settings.h"
#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

struct SimulateOptions {
  std::uint64_t seed = 1;
  double noise = 1;  // times the stated sigmas
  int threads = 1;
};

Recordings simulate(const Program& program, const Settings& settings,
                    const SimulateOptions& options);

}  // namespace talus
