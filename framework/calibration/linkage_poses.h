// A measured frame as an instrumented linkage gives it: the linkage's readings become the frame's
// columns, by the linkage's own model. What follows need not know that a linkage measured it.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "framework/kinematics/posture.h"
#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

class LinkagePoses {
 public:
  // `wanted`: the frame feature to be measured; the linkage's model must measure one of that name,
  // and have no unknowns. Records on the linkage's tape; copies may be used by several threads.
  LinkagePoses(const Program& linkage, const Feature& wanted);

  // T_in_at at raw readings.
  Eigen::Isometry3d operator()(std::span<const double> readings);
  // The table with the columns of `wanted` (of `program`) computed from its readings; a pose with a
  // reading missing has no measured frame. Other columns are kept.
  Recordings measured(const Recordings& recordings, const Program& program);

 private:
  const Program* linkage_;
  std::vector<int> columns_;
  Posture posture_;
  int in_, at_;
};

// The seven columns of a frame feature.
void set_frame_columns(Recordings& recordings, const Program& program,
                       const std::vector<int>& columns,
                       const std::vector<Eigen::Isometry3d>& poses);

}  // namespace talus
