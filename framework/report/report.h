// What a fit is told as: text for people, JSON for programs (contracts in docs/json.md), and the
// calibrated model, which is a model file again with the tolerances shrunk to the standard
// uncertainties.
#pragma once

#include <string>

#include "framework/calibration/fit.h"
#include "framework/metrology/measure.h"
#include "framework/model/model.h"

namespace talus {

struct ReportContext {
  std::string command, model_file, recordings_file;
  const Measured* measured = nullptr;  // where features were probed
};

// Probed shapes and datums: points, RMSE of the fits, squareness. Empty where nothing was probed.
std::string probing_text(const Program& program, const Measured& measured);

std::string text_report(const Program& program, const Fit& fit, const ReportContext& context);
std::string json_report(const Program& program, const Fit& fit, const ReportContext& context);

// The model with fitted values and, as tolerances, their standard uncertainties. Parameters that
// the recordings do not see keep their tolerance.
Model calibrated_model(const Model& model, const Program& program, const Fit& fit);

// Writes beside, then renames: a file is there whole or not at all.
void write_file(const std::string& file, const std::string& text);

}  // namespace talus
