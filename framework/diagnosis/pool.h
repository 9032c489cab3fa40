// What could be recorded next, made linear beside what was recorded, so that next_poses.h can
// choose:
//     free poses   drawn at random within the ranges of sensors and unknowns, under circumstances
//                  that a recording would have: joints approached from either side, the lightest or
//                  heaviest payload; where loops must close, moved until they do (closing.h)
//     poses again  some that were recorded, every joint approached from the other side, or with
//                  another payload: whatever holds the linkage lets it go there
//     turned       both in other mountings (mountings.h), where asked for
//
// Where a model states no range of a sensor or unknown, what was visited is widened: by half its
// width on both sides, that of a sensor to a third of a turn at least. Payloads are none and the
// heaviest seen, or the ends of the stated range. The time goes on after the last pose. Only where
// the recordings have a sense of approach is there one here.
#pragma once

#include "framework/diagnosis/next_poses.h"
#include "framework/diagnosis/pool_drawing.h"
#include "framework/diagnosis/stage.h"

namespace talus {

struct Pool {
  std::vector<Coordinate> coordinates;  // of the settings, with the ranges they were drawn from
  std::vector<bool> assumed;            // of each: its range is not stated
  Recordings recordings;                // recorded rows, then those of the pool
  std::vector<std::size_t> rows;        // of `recordings`, of each pose below
  Settings settings;                    // of each pose below
  std::vector<Origin> origins;          // of each pose below
  std::vector<Mounting> mountings;
  std::vector<std::string> loops;     // closures that all poses keep
  Baseline baseline;                  // of the recorded rows
  std::vector<std::size_t> recorded;  // row of each pose of the baseline
  Suspects suspects;  // forms over both; their columns are those of the recorded rows
  std::vector<PoolPose> poses;
};

// `fit_x`: the solution of the calibration of the model (Fit::x); `null` its trial. InputError
// where the model has a feature that cannot be simulated.
Pool pool_of(const Ground& ground, const Recordings& recordings, const Trial& null,
             const std::vector<double>& fit_x, const PoolOptions& options);

}  // namespace talus
