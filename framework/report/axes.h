// Functional axes as text for people and as JSON for programs (docs/json.md): where they lie, how
// they have changed, how well the changes were measured.
#pragma once

#include <string>
#include <vector>

#include "framework/calibration/axes_changes.h"

namespace talus {

struct AxesContext {
  std::string model_file, linkage_file, actual_file;
  std::vector<std::string> recordings_files;
  AxisLabels labels;
};

std::string axes_text(const AxisFinder& finder, const AxesResult& result,
                      const AxesContext& context);
std::string axes_json(const AxisFinder& finder, const AxesResult& result,
                      const AxesContext& context);

}  // namespace talus
