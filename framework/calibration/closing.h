// Postures in which the model's loops are closed. Where a model has <closure>s, its coordinates
// depend on each other, so a posture cannot be drawn coordinate by coordinate. A drawn posture goes
// to the nearest one that closes all loops: coordinates that are held stay, the sensors' readings
// and the unknowns of each pose that the closures depend on move (inverse.h solves for them). What
// effects do to the loops, with the loads and senses of approach of the very postures, counts.
//
// A closure's sigma is how far a loop may be open, by play or by what the model leaves out. With
// noise each loop is left open by a gap drawn from it, as far as the coordinates that move can make
// one.
#pragma once

#include <cstdint>

#include "framework/calibration/settings.h"
#include "framework/kinematics/program.h"

namespace talus {

// Has the program a residual of a closed loop?
bool has_loops(const Program& program);

struct ClosingOptions {
  std::vector<bool> held;             // of each coordinate; empty: none
  const Recordings* table = nullptr;  // circumstances of the postures
  double noise = 0;                   // gaps, times the closures' sigmas
  int attempts = 1;  // starts for each posture: the drawn one, then others, all over the ranges
  std::uint64_t seed = 1;
  int threads = 1;
};

struct Closed {
  Settings settings;          // with their circumstances
  std::vector<bool> reached;  // of each posture: could its loops be closed? (nothing free: true)
};

// `program` is changed while this runs and is as before afterwards.
Closed close_loops(Program& program, Settings drawn, const ClosingOptions& options = {});

// Postures drawn as by random_settings, those left out that cannot be closed: `count` of them, or
// fewer where most of what the ranges allow cannot be closed. InputError where none can.
Settings random_closed_settings(Program& program, int count, const ClosingOptions& options);

}  // namespace talus
