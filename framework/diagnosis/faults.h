// First rule out the ordinary: columns exchanged, mis-signed or in another unit, measurements
// beside the wrong readings, a sensor that stands still, rows copied, a local minimum or a twin
// solution.
//
// Physics is small, such faults are not. So they are looked for only where the baseline fits badly,
// or well but with a geometry far from its nominal one (a sign may be absorbed by a mirrored
// linkage). Each is a correction of the table (corrections.h) without any free number: the model is
// refitted to the corrected copy, from its nominal values. With c twice the cost, priors included,
// per degree of freedom, before and c' after, a correction is claimed where
//     c' < c / 5   and   |ln c'| < ln c / 2    (nearer to the noise than to where it was),
// or where the priors' share falls by as much and the recordings are fitted as well. What is left
// may be physics and goes on to the search for that, with the corrected copy. Two faults at once
// are found as well, each of which alone mends little.
#pragma once

#include <string>
#include <vector>

#include "framework/calibration/fit.h"
#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

struct Fault {
  std::string kind;   // "swapped-columns", "wrong-sign", "wrong-unit", "shifted-rows", ...
  std::string where;  // the model's sensors, joints or measurements, separated by commas
  std::string statement;
  std::vector<int> poses = {};  // their numbers, where it concerns some only
  bool note = false;            // worth knowing, but nothing is wrong with the recordings
};

struct FaultOptions {
  int threads = 1;
  std::uint64_t seed = 1;
};

struct Faults {
  std::vector<Fault> found;
  bool corrected = false;             // the recordings differ from those given
  Recordings recordings;              // corrected where that could be done
  std::vector<std::size_t> left_out;  // rows that are copies of others
  double before = 0, after = 0;       // chi-square per degree of freedom (where columns were tried)
  int tried = 0;                      // corrections
};

// `fit`: the calibration to the rows to fit; null where there is none (a triangle that does not
// close). Held-out rows decide nothing; corrections hold for them as well.
Faults find_faults(const Program& program, const Recordings& recordings, const Split& split,
                   const Fit* fit, const FaultOptions& options = {});

// Columns that stand still, rows copied, measurements that repeat those of the row before: seen
// without any fit (faults_rows.cpp).
std::vector<Fault> faults_of_rows(const Program& program, const Recordings& recordings,
                                  const std::vector<std::size_t>& rows,
                                  std::vector<std::size_t>& copies);

}  // namespace talus
