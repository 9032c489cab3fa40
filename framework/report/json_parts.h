// Parts that several JSON reports share.
#pragma once

#include <nlohmann/json.hpp>

#include "framework/report/report.h"

namespace talus {

// A fit as `baseline` and `after` show it.
nlohmann::ordered_json json_of(const Fit& fit, const UnitSystem& units);

}  // namespace talus
