// Recordings: a table with one row per pose (configuration, setting) and one column per reading,
// measured value or covariate, in internal units (mm, rad, s, kg, degC).
//
//     # comment lines are allowed
//     pose,time[s],session,theta1[deg],E.x[mm],E.y[mm],use
//     1,0.0,1,-27.05,242.9,32.9,fit
//
// A missing value is an empty cell and is read as NaN; `inf`, `nan` and text are errors. A unit is converted,
// never guessed: a column without a bracket is a plain number.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/model/error.h"
#include "framework/model/units.h"

namespace talus {

struct RecordedColumn {
  std::string name;
  Unit unit;                   // as written in the header
  std::vector<double> values;  // internal units; NaN where the cell is empty
  Place place;                 // of the header cell
};

class Recordings {
 public:
  std::string file;
  std::vector<RecordedColumn> columns;
  std::vector<int> lines;  // the file's line of each row, for messages

  std::size_t rows() const { return lines.size(); }
  const RecordedColumn* find(std::string_view name) const;
  // The column, or InputError with the place of the header line, the nearest column name, and, where the
  // dimension differs, the unit found and those expected.
  const RecordedColumn& get(std::string_view name, Dimension dimension) const;
  // The text column `use`, where there is one: true for fit, false for check.
  std::optional<std::vector<bool>> use;
};

Recordings read_recordings(const std::string& file);                                     // CSV
Recordings parse_recordings(std::string_view text, const std::string& file);
std::string write_recordings(const Recordings& recordings);                              // CSV

// Rows to fit and rows to check. With a `use` column that decides. Otherwise `check_share` of the groups is
// drawn at random from the seed; a group is what must not be torn apart: the rows with equal values in
// `group_columns` (by default those columns that the model's unknowns are shared by, `star`-like ids the user names
// with --group) and rows that repeat one setting (equal readings within `repeat_tolerance`).
struct Split {
  std::vector<std::size_t> fit, check;  // row numbers, increasing
  std::vector<int> group;               // of each row
};
struct SplitOptions {
  double check_share = 0.3;
  std::uint64_t seed = 1;
  std::vector<std::string> group_columns;
  std::vector<std::string> reading_columns;  // to recognise repeats of a setting
  double repeat_tolerance = 1e-9;            // internal units
};
Split split_rows(const Recordings& recordings, const SplitOptions& options);

// k folds by whole groups: the rows to hold out in each.
std::vector<std::vector<std::size_t>> folds(const std::vector<int>& group, int k, std::uint64_t seed);

}  // namespace talus
