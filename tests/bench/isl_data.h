// Made-up recordings of the linkage of Bonny, Hull and Howell (2013), for the benchmarks.
//
// The linkage behind them has the published calibrated parameters (their Table 2). Joints are
// placed at random within +-60 deg; the readings are off by 0.01 deg (one standard deviation), the
// measured frames by 0.005 mm per coordinate and 0.002 deg per component of the rotation vector.
// The same seed gives the same poses on every machine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/isl_model.h"

namespace talus::bench {

struct IslPose {
  std::array<double, 6> readings;  // rad
  std::array<double, 9> rotation;  // measured, of E in B, row by row
  std::array<double, 3> position;  // measured, mm
};

using IslPoses = std::vector<IslPose>;

const IslParameters& isl_nominal();    // Table 2, before calibration
const IslParameters& isl_optimised();  // Table 2, after calibration

// Bonny's best weighting: 0.35 on squared mm, 0.65 on squared degrees.
IslFactors isl_published_factors();

// One over the standard deviations of the coordinate measuring machine, encoders left out.
IslFactors isl_instrument_factors();

IslPoses isl_poses(int count, std::uint64_t seed = 1);

// What a calibration from the nominal parameters gives; the same for every solver under test.
struct Calibration {
  IslParameters parameters;
  double initial_cost = 0, final_cost = 0;  // half the sum of squared, scaled residuals
  int iterations = 0;
  double seconds = 0;  // from the poses to the parameters, building the problem included
  bool converged = false;
};

// pose, theta1[deg] .. theta6[deg], E.x[mm] .. E.z[mm], E.qw .. E.qz, use (always fit).
void write_isl_recordings(const std::string& file, const IslPoses& poses);

}  // namespace talus::bench
