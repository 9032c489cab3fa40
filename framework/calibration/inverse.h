// The coordinates of recorded poses. A coordinate that the table has a column for (a sensor's, or
// one named like an unknown) is taken from there; the others that the measured features depend on
// are found by inverse kinematics: the calibration problem with its parameters held, in which they
// are unknowns of their pose, solved for from several starts. So a table of readings, a table of
// measured frames, and a table with some of both are all understood.
//
// What neither is there nor can be found: a sensor's reading is an error; an unknown that no
// measured feature depends on, or that is shared by several rows, stays at its start. A covariate
// that is not there has its usual value.
#pragma once

#include <string>
#include <vector>

#include "framework/calibration/settings.h"
#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

enum class Reach {
  exactly,  // a pose that cannot be reached, or is incomplete, is an InputError that names its line
  if_possible,  // the same, but such a pose is only marked
  nearest,      // least squares, as a calibration weighs the residuals; priors of unknowns count
};

struct Recovered {
  Settings settings;                // NaN where a row lacks the values
  std::vector<std::string> solved;  // names of the coordinates found from the measured features
  double misfit = 0;                // root mean square of the weighted residuals left
  enum class How { inside, outside, not_at_all };  // the sensors' ranges
  std::vector<How> how;                            // how each pose was reached
  std::size_t count(How which) const;
};

// `program` is changed while this runs and is as before afterwards. With `near` (a setting for each
// row) what is to be found is looked for from there first, and there may be more of it than
// residuals determine: then the nearest is taken. `attempts`: starts, at most; 0: as usual.
Recovered recover(Program& program, const Recordings& recordings, Reach reach, int threads,
                  const Settings* near = nullptr, int attempts = 0);

// Settings to simulate: where a sensor's reading is missing, the poses are to be reached exactly;
// unknowns alone are found as a calibration finds them.
Settings settings_from(Program& program, const Recordings& recordings, int threads);

}  // namespace talus
