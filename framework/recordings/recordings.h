// Recordings: a table with one row per pose (configuration, setting) and one column per reading,
// measured value or covariate, in internal units (mm, rad, s, kg, degC).
//
//     # comment lines are allowed
//     pose,time[s],session,theta1[deg],E.x[mm],E.y[mm],use
//     1,0.0,1,-27.05,242.9,32.9,fit
//
// A missing value is an empty cell and is read as NaN; `inf`, `nan` and text are errors. A unit is
// converted, never guessed: a column without a bracket is a plain number. Marker files (TRC) are
// read as well: each marker NAME becomes the point NAME.x, NAME.y, NAME.z beside pose and time.
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

// The covariance of measured columns that were worked out from raw points, row by row (internal
// units; row-major over `columns`).
struct MeasuredNoise {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> covariance;
};

class Recordings {
 public:
  std::string file;
  std::vector<RecordedColumn> columns;
  std::vector<int> lines;  // the file's line of each row, for messages
  int header_line = 0;

  MeasuredNoise noise;

  // The text column `use`, where there is one: true for fit, false for check.
  std::optional<std::vector<bool>> use;

  std::size_t rows() const { return lines.size(); }
  const RecordedColumn* find(std::string_view name) const;

  // The column, or InputError with the place of the header, the nearest column name, and, where
  // the dimension differs, the unit found and those expected.
  const RecordedColumn& get(std::string_view name, Dimension dimension) const;
};

Recordings read_recordings(const std::string& file);  // CSV; TRC if the name ends in .trc
Recordings parse_recordings(std::string_view text, const std::string& file);  // CSV
Recordings parse_trc(std::string_view text, const std::string& file);
std::string write_recordings(const Recordings& recordings);  // CSV; reads back as the same numbers

// Rows to fit and rows to check. With a `use` column that decides. Otherwise `check_share` of the
// groups is drawn at random from the seed, at least one and never all. A group is what must not be
// torn apart: rows with equal values in all columns of one entry of `group_columns` (those the
// model's unknowns are shared by, `star`-like ids the user names with --group) and rows that repeat
// one setting. Repeats are rows whose readings, each sorted by size, follow without a gap larger
// than `repeat_tolerance`: with a tolerance larger than the steps of a slow motion, all of that
// motion is one group.
struct Split {
  std::vector<std::size_t> fit, check;  // row numbers, increasing
  std::vector<int> group;               // of each row, numbered as they first appear
};
struct SplitOptions {
  double check_share = 0.3;
  std::uint64_t seed = 1;
  std::vector<std::vector<std::string>> group_columns;
  std::vector<std::string> reading_columns;  // to recognise repeats of a setting
  double repeat_tolerance = 1e-9;            // internal units
};
Split split_rows(const Recordings& recordings, const SplitOptions& options);

// k folds by whole groups, of about equal numbers of rows: the rows to hold out in each. Fewer
// than k where there are fewer groups, none for a single group.
std::vector<std::vector<std::size_t>> folds(const std::vector<int>& group, int k,
                                            std::uint64_t seed);

}  // namespace talus
