#include "framework/calibration/split_options.h"

#include <cmath>
#include <set>

namespace talus {

SplitOptions split_options(const Program& program, const Recordings& recordings, double check,
                           const std::vector<std::vector<std::string>>& groups,
                           std::uint64_t seed) {
  SplitOptions split;
  split.check_share = check;
  split.seed = seed;
  split.group_columns = groups;
  if (!program.settings.groups.empty()) split.group_columns.push_back(program.settings.groups);
  for (const Unknown& u : program.unknowns)
    if (!u.per.empty()) split.group_columns.push_back(u.per);
  if (const RecordedColumn* session = recordings.find("session")) {
    std::set<double> sessions;
    for (double v : session->values)
      if (!std::isnan(v)) sessions.insert(v);
    if (sessions.size() >= 4 && split.group_columns.empty())
      split.group_columns.push_back({"session"});
  }
  for (const Reading& r : program.readings)
    if (!r.covariate && recordings.find(r.column)) split.reading_columns.push_back(r.column);
  return split;
}

}  // namespace talus
