// What is registered, for other programs: a plugin's declaration as JSON, in the units of a model
// file that names none (mm, deg, s, kg). Of an effect everything that a script needs to write one
// into a model: where it acts, its amounts and their usual sizes, its settings and their values to
// try, which amounts go together, what it needs to be recorded.
#pragma once

#include <nlohmann/json.hpp>

#include "framework/registry/plugin.h"

namespace talus {

nlohmann::ordered_json json_of(const Plugin& plugin);

}  // namespace talus
