// A fitted hypothesis made ready for screening: what every suspect that is not in it would add.
#pragma once

#include "framework/diagnosis/hypothesis.h"
#include "framework/diagnosis/screen.h"

namespace talus {

struct Stage {
  Suspects suspects;  // candidates moved into the screen
  Screen screen;
  std::vector<std::size_t> rows;    // recorded row of each pose of the screen
  std::vector<int> when;            // its place in time
  double chi2 = 0, dof = 0, p = 1;  // of the hypothesis, by the stated noise
  bool studentised = false;         // the noise was taken from what is left over

  // The pick as an effect to be fitted: its change point written out, amounts as estimated.
  Accepted accepted(const Ground& ground, const Score& score) const;
};

struct StageOptions {
  SuspectOptions suspects;
  bool noise_known = true;
};

// The recordings with every column that effects at any place could ask for, loads at the fitted
// geometry.
Recordings with_circumstances(const Model& model, const Registry& registry, const Program& program,
                              const Recordings& recordings, std::span<const double> x);

// A hypothesis made linear where the fields at all places are zero: what a stage is made of.
struct Linearised {
  std::shared_ptr<const Program> program;  // with fields
  Baseline baseline;
  Suspects suspects;
  Eigen::MatrixXd columns;  // whitened, of all that is free: fields by EffectPlace::first_field
  PoseSlots slots;
  Eigen::MatrixXd latents;        // poses x unknowns of each pose
  std::vector<std::size_t> rows;  // recorded row of each pose
  std::vector<int> when;
  std::vector<int> parameters;  // of the program: of each column of the baseline
};
Linearised linearised(const Ground& ground, const Trial& trial, const StageOptions& options = {});

Stage stage_of(const Ground& ground, const Trial& trial, const StageOptions& options = {});

}  // namespace talus
