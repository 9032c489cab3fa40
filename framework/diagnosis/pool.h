// Poses that could be recorded next: drawn at random within the sensors' ranges, with the
// circumstances that a recording would have, and made linear beside the recorded ones, so that
// next_poses.h can choose among them.
//
// Where a model states no range of a sensor or unknown, what was visited is widened: by half its
// width on both sides, that of a sensor to a third of a turn at least. Payloads are those seen,
// approaches of both senses where approaches were recorded, the time goes on after the last pose.
// Unknowns shared by groups are those of the last pose that was fitted; loops are closed.
#pragma once

#include <cstdint>

#include "framework/calibration/settings.h"
#include "framework/diagnosis/next_poses.h"
#include "framework/diagnosis/stage.h"

namespace talus {

struct Pool {
  std::vector<Coordinate> coordinates;  // of the settings, with the ranges they were drawn from
  std::vector<bool> assumed;            // of each: its range is not stated
  Recordings recordings;                // recorded rows, then those of the pool
  std::vector<std::size_t> rows;        // of `recordings`, of each pose below
  Settings settings;                    // of each pose below
  Baseline baseline;                    // of the recorded rows
  Suspects suspects;  // forms over both; their columns are those of the recorded rows
  std::vector<PoolPose> poses;
};

// `fit_x`: the solution of the calibration of the model (Fit::x); `null` its trial. InputError
// where the model has a feature that cannot be simulated.
Pool pool_of(const Ground& ground, const Recordings& recordings, const Trial& null,
             const std::vector<double>& fit_x, int count, std::uint64_t seed,
             const SuspectOptions& suspects = {});

}  // namespace talus
