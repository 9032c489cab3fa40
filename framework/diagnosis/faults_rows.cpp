// Faults that the table shows by itself.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "framework/diagnosis/faults.h"

namespace talus {
namespace {

// Fewer rows may well agree in a column.
constexpr std::size_t fewest = 5;
// Values agree to the last digit by chance, but hardly in so many columns.
constexpr std::size_t columns_needed = 3;

int pose_of(const Recordings& recordings, std::size_t row) {
  const RecordedColumn* pose = recordings.find("pose");
  return pose ? static_cast<int>(pose->values[row]) : static_cast<int>(row) + 1;
}

using Columns = std::vector<const RecordedColumn*>;

// Those that change at all.
Columns changing(Columns columns, const std::vector<std::size_t>& rows) {
  std::erase_if(columns, [&](const RecordedColumn* c) {
    return !c || std::all_of(rows.begin(), rows.end(),
                             [&](std::size_t row) { return c->values[row] == c->values[rows[0]]; });
  });
  return columns;
}

// The values of a row, empty where one is missing.
std::vector<double> key(const Columns& columns, std::size_t row) {
  std::vector<double> values;
  for (const RecordedColumn* c : columns)
    if (std::isnan(c->values[row]))
      return {};
    else
      values.push_back(c->values[row]);
  return values;
}

std::string list(const std::vector<int>& poses) {
  std::vector<std::string> words;
  for (int p : poses) words.push_back(std::to_string(p));
  return join(words);
}

}  // namespace

std::vector<Fault> faults_of_rows(const Program& program, const Recordings& recordings,
                                  const std::vector<std::size_t>& rows,
                                  std::vector<std::size_t>& copies) {
  std::vector<Fault> found;
  if (rows.size() < fewest) return found;
  Columns readings, measured;
  auto still = [&](const RecordedColumn* c, const std::string& where) {
    if (!c || std::isnan(c->values[rows[0]])) return;
    if (std::all_of(rows.begin(), rows.end(),
                    [&](std::size_t row) { return c->values[row] == c->values[rows[0]]; }))
      found.push_back({"constant-column",
                       where,
                       fmt::format("The column {} has the same value in all rows: a sensor that "
                                   "stands still, or a column filled in.",
                                   c->name),
                       {}});
  };
  for (const Reading& r : program.readings) {
    readings.push_back(recordings.find(r.column));
    still(readings.back(), r.sensor);
  }
  std::string features;
  for (const Feature& f : program.features) {
    features += (features.empty() ? "" : ", ") + f.name;
    for (int c : f.columns) {
      measured.push_back(recordings.find(program.columns[c].name));
      still(measured.back(), f.name);
    }
  }
  readings = changing(std::move(readings), rows);
  measured = changing(std::move(measured), rows);
  Columns all = readings;
  all.insert(all.end(), measured.begin(), measured.end());
  std::map<std::vector<double>, std::size_t> whole, taken;
  Fault same{"duplicate-rows", features, "", {}}, stale{"repeated-measurements", features, "", {}};
  for (std::size_t row : rows) {
    const std::vector<double> everything = key(all, row), seen = key(measured, row);
    if (everything.size() >= columns_needed && !whole.emplace(everything, row).second) {
      same.poses.push_back(pose_of(recordings, row));
      copies.push_back(row);
    } else if (seen.size() >= columns_needed && !readings.empty() &&
               !taken.emplace(seen, row).second) {
      stale.poses.push_back(pose_of(recordings, row));
    }
  }
  if (!same.poses.empty()) {
    same.statement = fmt::format(
        "Poses {} repeat the readings and measurements of an earlier row to the last digit: copies "
        "of rows, which tell nothing new.",
        list(same.poses));
    found.push_back(std::move(same));
  }
  if (!stale.poses.empty()) {
    stale.statement = fmt::format(
        "Poses {} repeat the measurements of an earlier row to the last digit although the "
        "readings differ: not measured anew.",
        list(stale.poses));
    found.push_back(std::move(stale));
  }
  return found;
}

}  // namespace talus
