// Long lists of numbers of a state, made small. A coordinate that is a column of the recordings is
// {"column": its number}; one that an earlier state has as well is {"state": i, "coordinate": j};
// residuals and all else is {"f32": text}, base64 of little-endian floats of 32 bits (seven
// digits), NaN where there is none. The recordings themselves stay as they were read.
#pragma once

#include <nlohmann/json.hpp>

namespace talus {

nlohmann::ordered_json packed(const nlohmann::ordered_json& values);  // of an array of numbers

// `state` as json_of makes it; `earlier`: those before it, packed; `columns` of its recordings.
void pack(nlohmann::ordered_json& state, const nlohmann::ordered_json& earlier,
          const nlohmann::ordered_json& columns);

}  // namespace talus
