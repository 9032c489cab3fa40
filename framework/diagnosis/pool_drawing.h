// The poses of a pool (pool.h) before they are made linear: where to go and under which
// circumstances, as rows behind the recorded ones.
#pragma once

#include <cstdint>

#include "framework/calibration/settings.h"
#include "framework/diagnosis/hypothesis.h"
#include "framework/diagnosis/mountings.h"

namespace talus {

struct Origin {
  int again = -1;  // recorded row that is repeated; -1: a free pose
  bool other_side = false;
  int mounting = -1;  // of the drawing; -1: as it was
};

struct Drawn {
  std::vector<double> setting;  // by coordinate
  Origin origin;
};

struct Drawing {
  std::vector<Coordinate> coordinates;  // of the settings, with the ranges they were drawn from
  std::vector<bool> assumed;            // of each: its range is not stated
  std::vector<Mounting> mountings;
  std::vector<std::string> loops;  // closures that all poses keep
  Recordings recordings;           // recorded rows, then one for each of
  std::vector<Drawn> drawn;

  // Of a row behind the recorded ones.
  const Drawn& at(std::size_t row) const { return drawn[row - (recordings.rows() - drawn.size())]; }
};

struct PoolOptions {
  int count = 300;  // of free poses
  std::uint64_t seed = 1;
  bool turned = false;
  SuspectOptions suspects;
};

// `program` is that of the model, its parameters at the fitted values `x`; where a loop must close,
// its sensors get the ranges drawn from.
Drawing drawn_poses(const Ground& ground, Program& program, const Recordings& recordings,
                    const Trial& null, const std::vector<double>& x, const PoolOptions& options);

}  // namespace talus
