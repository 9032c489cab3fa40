// Harder than rows drawn at random: the extended model and the one as given, fitted without a whole
// region of a circumstance (a reading, an unknown of the pose, the time, the temperature, a
// payload) or a whole session, and judged there. Random rows test interpolation only.
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

// A number of each recorded row, by which regions are made.
struct BlockCovariate {
  std::string name, unit;      // as results call it: "theta3", "deg"
  double factor = 1;           // internal units of one
  std::vector<double> values;  // of all rows; NaN: not known
};
BlockCovariate block_covariate(const RecordedColumn& column);

// Both ends of these (a sixth of the rows each; where there are few values, all rows of the lowest
// and of the highest), and the last session where there are several. Rows of `split` only: fitted
// to its rows to fit that lie outside.
std::vector<Block> held_out_blocks(const BlockModel& given, const BlockModel& extended,
                                   const Recordings& recordings, const Split& split,
                                   const std::vector<BlockCovariate>& covariates,
                                   const FitOptions& options);

}  // namespace talus
