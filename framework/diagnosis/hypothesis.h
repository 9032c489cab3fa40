// A hypothesis: the model with some effects written into it, fitted for real, all parameters free.
#pragma once

#include <map>
#include <memory>

#include "framework/calibration/fit.h"
#include "framework/diagnosis/suspects.h"

namespace talus {

// An effect that is held to be at work, with its amounts as fitted (internal units).
struct Accepted {
  Suspect suspect;
  Way way;
  std::vector<double> amounts, std;
  double occam = 0;  // ln of what it is charged for its amounts and ways
  double scale = 0;  // tolerance of many amounts at once, in typical ones; 0: not known
};

// The model with the effects as further elements; amounts start at their values.
Model extended(const Model& model, const std::vector<Accepted>& effects, const UnitSystem& units);

// What all hypotheses share.
struct Ground {
  const Model* model;
  const Registry* registry;
  const Recordings* recordings;  // with covariates and loads
  std::vector<std::size_t> rows;
  int threads = 1;
  // Where the noise is not stated: divisors of the program's rows, so that what the model as given
  // leaves of each has unit variance.
  std::vector<double> scale;
};

// A fit of a hypothesis to the rows.
struct Trial {
  std::vector<Accepted> effects;
  std::shared_ptr<const Program> program;  // of the extended model
  std::vector<double> x;                   // parameters, then shared unknowns
  std::map<std::string, double> values;    // of x by name
  double cost2 = 0;                        // chi-square with the priors of the geometry
  double chi2 = 0;                         // of the rows
  bool converged = false;
  Eigen::MatrixXd latents;  // poses x unknowns of each pose, in the order of Problem::linear
};

struct TrialOptions {
  int max_iterations = 60;
  bool from_nominal = false;  // geometry starts at its nominal values as well; the better is taken
};

// Ground::scale, from a calibration of the model itself; empty where the noise is stated.
std::vector<double> scale_of_rows(const Ground& ground, const Fit& fit);

// The baseline's trial from a calibration of the model itself.
Trial trial_of(const Ground& ground, const Fit& fit);

// Fits the model with these effects, starting from `near` (whose geometry and whitening it takes).
Trial fit_trial(const Ground& ground, const std::vector<Accepted>& effects, const Trial& near,
                const TrialOptions& options = {});
// Several, in parallel; in their order.
std::vector<Trial> fit_trials(const Ground& ground,
                              const std::vector<std::vector<Accepted>>& hypotheses,
                              const Trial& near, const TrialOptions& options = {});

}  // namespace talus
