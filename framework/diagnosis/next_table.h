// The table of poses to record next: their numbers, readings, unknowns, and the circumstances that
// one can choose (payload, sense of approach, group). What simulation and a recording start from.
#pragma once

#include "framework/diagnosis/pool.h"

namespace talus {

// Adds one row; `row` is that of the pool's recordings.
void add_to_table(Recordings& table, const Program& program, const Pool& pool,
                  const std::vector<double>& coordinates, std::size_t row);

}  // namespace talus
