// Static loads (kinematics/loads.h) as columns of the recordings, worked out at given parameters,
// so that whatever depends on a load reads it like any other covariate. For every joint J:
//
//     load:J.fx ... fz [N], mx ... mz [N*mm]         at the axis frame: all that is distal
//     load:J.tip_fx ... tip_fz, tip_mx ... tip_mz    at the frame behind: without the link's weight
//     load:J.weight_x ... weight_z [N]               the link's own weight, in the frame behind
//     load:J.own_mx ... own_mz [N*mm]                its moment about that frame's origin
//     load:J.span_x ... span_z [mm]                  from the frame before to the frame behind
//
// Gravity points as the model says, or along the row's columns gravity.x, gravity.y, gravity.z, in
// the same frame: rows recorded with the linkage turned. Where these are empty it is the model's.
//
// Where a reading or a payload's cell is missing, the columns that need it are empty. A joint
// whose loads depend on an unknown of the model has no columns: they would change while it is
// found.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "framework/kinematics/loads.h"
#include "framework/recordings/recordings.h"

namespace talus {

constexpr std::array<const char*, 3> gravity_columns = {"gravity.x", "gravity.y", "gravity.z"};

// Is there anything heavy, and a gravity to make it so?
bool has_loads(const Program& program);

// The frames behind those joints whose loads depend on no unknown.
std::vector<int> loaded_frames(const Program& program);

// Payloads without a column in the recordings, by its name: they count as zero.
std::vector<std::string> missing_payloads(const Program& program, const Recordings& recordings);

// Row by row, by frame. Parameters in the program's order.
std::vector<std::vector<LinkLoad>> recorded_loads(const Program& program,
                                                  const Recordings& recordings,
                                                  std::span<const double> parameters);

// The recordings with these columns, in place of those of an earlier call; unchanged where the
// model has no loads.
Recordings with_loads(const Program& program, const Recordings& recordings,
                      std::span<const double> parameters);

}  // namespace talus
