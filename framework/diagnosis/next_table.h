// The table of poses to record next: their numbers, readings, unknowns, and the circumstances that
// one can choose (payload, sense of approach, direction of gravity, group). What simulation and a
// recording start from.
#pragma once

#include <set>

#include "framework/diagnosis/pool.h"

namespace talus {

// Adds one row; `row` is that of the pool's recordings.
void add_to_table(Recordings& table, const Program& program, const Pool& pool,
                  const std::vector<double>& coordinates, std::size_t row);

double pose_number(const Recordings& recordings, std::size_t row);

// What to do at the last row of the table beside going to its readings: "pose 17 again, from the
// other side, joint3 from above, with 2 kg". `sides`: joints whose approach matters.
std::string how_to_record(const Recordings& table, const Program& program, const Pool& pool,
                          const Origin& origin, const std::set<std::string>& sides);

}  // namespace talus
