// A linkage as a page moves it: a function of slots in JavaScript (javascript.h), whose result is
// one flat list of numbers, and a plain description of what these numbers are: frames, axes, bones,
// limbs, measured features, coordinates with their limits, and the equations of the chain. The
// shape of the description is told at the top of viewer.js.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "framework/kinematics/program.h"
#include "framework/kinematics/skeleton.h"
#include "framework/recordings/recordings.h"

namespace talus {

struct PageLinkage {
  nlohmann::ordered_json scene;
  std::string script;                // "function(s,o){...}"
  std::vector<std::int32_t> wanted;  // the nodes whose values it yields, in their order
};

// What is seen is settled at rest (which joints stand in one point, how long a body is); the
// coordinates' limits come from the sensors' ranges or, where none are stated, from the recordings.
PageLinkage page_linkage(const Program& program, const Recordings* recordings = nullptr);

// All slots' values: parameters as given, or at their nominal values; all else at rest.
std::vector<double> page_slots(const Program& program, std::span<const double> parameters = {});

}  // namespace talus
