// The motion of a linkage as a table: pose by pose the coordinates, and position and orientation of
// frames in one another.
//
// With quaternions the columns are those of a measured frame (E.x[mm] ... E.qw ...), so the table
// is a recording. With angles they are the general six-parameter transform: three translations and
// three ordered rotations of any axis sequence (angles.h), as
//     flexion=z, internal=x, inversion=y     R = Rz Rx Ry (Nordquist and Hull 2009, eq. 4)
//     roll=x, pitch=z, yaw=y                 R = Rx Rz Ry (Storey et al. 2006, eq. 19)
// in (-180, 180] deg, the middle one in [-90, 90] or [0, 180]; they are not unwrapped.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "framework/calibration/settings.h"
#include "framework/kinematics/angles.h"
#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

// Frame `of` seen from frame `in`.
struct FramePair {
  std::string of, in;
  Place place;
};
// "E in B", or "E": in the root. InputError where there is no such frame.
FramePair parse_frame_pair(const std::string& text, const Program& program, const Place& place);

struct NamedAngles {
  AxisSequence sequence;
  std::array<std::string, 3> names;
};
// "flexion=z, internal=x, inversion=y", or "zxy" for the names rz, rx, ry ("zxz": rz1, rx, rz2).
NamedAngles parse_named_angles(const std::string& text, const Place& place);

struct MotionOptions {
  // Empty: the frames of all measured features, or the last frame in the root.
  std::vector<FramePair> frames;
  std::optional<NamedAngles> angles;  // otherwise quaternions
  // Storey's vertices matrix: the twelve points of each limb (limb.h) in the root frame, as columns
  // LIMB.v1.x ... LIMB.v8.z, LIMB.centre.x ..., LIMB.end_x.x ... LIMB.end_z.z.
  bool limbs = false;
};

// `from`: the recordings that the settings were recovered from, for the columns `pose` and `time`
// and those that unknowns are shared by.
Recordings motion_table(const Program& program, const Settings& settings,
                        const MotionOptions& options, const Recordings* from = nullptr);

}  // namespace talus
