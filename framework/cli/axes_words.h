// The options of the commands that describe axes, in words.
#pragma once

#include <string>
#include <vector>

#include "framework/calibration/axes.h"
#include "framework/cli/commands.h"

namespace talus {

struct AxesWords {
  std::string of, by, frames = "body", labels;
  std::vector<std::string> reverse;

  bool anatomical() const { return frames == "anatomical"; }
  AxisLabels axis_labels() const;
};

// --of, --by, --frames, --labels, --reverse
void add_axes_words(CLI::App& command, AxesWords& words);

}  // namespace talus
