// Pictures of a linkage, pose after pose: what `talus draw` shows. All pictures of one call share
// their view and their scale.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/calibration/settings.h"
#include "framework/report/draw_picture.h"

namespace talus {

struct DrawOptions {
  std::string view = "-60, 25", up = "z";
  std::string hold;                 // the frame that stands still; default the root
  std::vector<std::string> frames;  // shown as triads; default the main ones; "all"
  double width = 1000, height = 750;
  std::vector<std::string> titles;            // before the coordinates of each pose: "row 3"
  std::function<void(double)> progress = {};  // share of the pictures made
};

// Every coordinate at rest.
std::vector<double> resting_pose(const Program& program);

// `between` poses between every two that follow each other; angles turn the shorter way.
Settings interpolated(const Program& program, const Settings& settings, int between);

// The pose of another linkage whose coordinates have the values of those of the same name (of the
// sensor or its column, or of the unknown); what has no namesake rests. InputError where none has.
Settings same_poses(const Program& program, const Settings& settings, const Program& other,
                    const Place& place);

// The linkage at each pose, and the ghosts at theirs. InputError where it has no place at a pose.
struct DrawnLinkage {
  const Program* program;
  Settings settings;
  std::string label = {};  // how the caption calls a ghost; default the model's name
};
std::vector<Picture> draw(const DrawnLinkage& linkage, const std::vector<DrawnLinkage>& ghosts,
                          const DrawOptions& options);

}  // namespace talus
