// Harder than rows drawn at random: the extended model and the one as given, fitted without a whole
// region of a reading or a whole session, and judged there. Random rows test interpolation only.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "framework/calibration/fit.h"

namespace talus {

struct Block {
  std::string name;  // "theta3 above 45.2 deg", "session 3"
  std::size_t poses = 0;
  double before = 0, after = 0;  // root mean squares in sigmas there
};

struct BlockModel {
  const Program* program;
  std::vector<double> start;  // of a fit
};

// Both ends of the readings in these columns (a sixth of the rows each), and the last session where
// there are several. Rows of `split` only: fitted to its rows to fit that lie outside.
std::vector<Block> held_out_blocks(const BlockModel& given, const BlockModel& extended,
                                   const Recordings& recordings, const Split& split,
                                   const std::vector<std::string>& columns,
                                   const FitOptions& options);

}  // namespace talus
