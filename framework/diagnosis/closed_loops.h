// Poses of a linkage with closed loops: a pose drawn at random leaves them open, and is moved as
// little as it takes to close them all.
//
// Newton's method on the gaps, the smallest step each time (pseudo-inverse), within the
// coordinates' ranges. The derivatives are those of the joints' axes (kinematics/posture.h).
#pragma once

#include "framework/calibration/settings.h"
#include "framework/kinematics/posture.h"

namespace talus {

class ClosedLoops {
 public:
  // Like Posture, it records on the program's tape.
  explicit ClosedLoops(const Program& program);

  bool none() const { return loops_.empty(); }
  std::vector<std::string> names() const;

  // Plain numbers and coordinates without a range are not moved. False where the loops do not close.
  bool close(std::vector<double>& setting, const std::vector<Coordinate>& coordinates,
             std::span<const double> parameters);

 private:
  struct Loop {
    std::string name;
    int in, at;                                // frames that coincide
    bool place, turn;                          // in their origins, in their axes
    std::vector<std::pair<bool, bool>> moves;  // of Posture::axes: does it move `at`, `in`
  };

  const Program* program_;
  Posture posture_;
  std::vector<Loop> loops_;
};

}  // namespace talus
