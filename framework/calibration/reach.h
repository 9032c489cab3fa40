// Inverse kinematics: the readings that bring a linkage's measured features to where they are
// asked to be. The readings become unknowns of their pose; the search goes from several starts, and
// a solution within the sensors' ranges is preferred.
#pragma once

#include <vector>

#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

struct Reached {
  enum class How { inside, outside, not_at_all };  // within the sensors' ranges or not
  std::vector<std::vector<double>> readings;       // [pose][reading], raw; of the nearest try
  std::vector<How> how;                            // of each pose
  std::size_t count(How which) const;
};

// Records on the program's tape; the program is the same afterwards.
Reached reach(Program& program, const Recordings& recordings, int threads);

}  // namespace talus
