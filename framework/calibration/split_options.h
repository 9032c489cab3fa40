// Which rows a model asks to be kept together when some are held out: what unknowns are shared by,
// the columns that <calibrate> names, sessions where there are enough, and what the user names.
#pragma once

#include <string>
#include <vector>

#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

// `groups`: columns whose equal rows must stay on one side, each entry together.
SplitOptions split_options(const Program& program, const Recordings& recordings, double check,
                           const std::vector<std::vector<std::string>>& groups, std::uint64_t seed);

}  // namespace talus
