// What a fit is told as: text for people, JSON for programs (contracts in docs/json.md), and the
// calibrated model, which is a model file again with the tolerances shrunk to the standard
// uncertainties.
#pragma once

#include <string>

#include "framework/calibration/fit.h"
#include "framework/metrology/measure.h"
#include "framework/model/model.h"

namespace talus {

// One weight of a sweep: weights w and 1 - w for the two residuals of <calibrate>.
struct SweepStep {
  double weight = 0;
  double mean = 0;  // RMSE of the check rows in % of full-scale range, mean over the measures
  int iterations = 0;
  std::vector<Measure> measures;  // of the check rows
};

// One fold: that share of the groups held out, everything fitted to the others.
struct FoldStep {
  std::size_t held_out = 0;  // poses
  double fit_rms = 0, heldout_rms = 0;
};

struct ReportContext {
  std::string command, model_file, recordings_file;
  const Measured* measured = nullptr;  // where features were probed
  std::vector<SweepStep> sweep = {};
  std::vector<FoldStep> folds = {};
};

std::size_t best_of(const std::vector<SweepStep>& sweep);  // index of the least mean
double all_folds(const std::vector<FoldStep>& folds);      // root mean square over held-out poses

// Probed shapes and datums: points, RMSE of the fits, squareness. Empty where nothing was probed.
std::string probing_text(const Program& program, const Measured& measured);

// Directions that are not seen, one to a line.
std::string unseen_text(const Identifiability& seen);

std::string text_report(const Program& program, const Fit& fit, const ReportContext& context);
std::string json_report(const Program& program, const Fit& fit, const ReportContext& context);

// The model with fitted values and, as tolerances, their standard uncertainties. Parameters that
// the recordings do not see keep their tolerance.
Model calibrated_model(const Model& model, const Program& program, const Fit& fit);

// Writes beside, then renames: a file is there whole or not at all.
void write_file(const std::string& file, const std::string& text);

}  // namespace talus
