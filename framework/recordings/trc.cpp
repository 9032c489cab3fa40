// Marker files (TRC, Motion Analysis): three lines of facts, two of headings, then a row per frame,
// all separated by tabs.
//
//     PathFileType  4  (X/Y/Z)  walk.trc
//     DataRate  CameraRate  NumFrames  NumMarkers  Units  OrigDataRate  ...
//     100  100  2  1  mm  100  1  2
//     Frame#  Time  LKNE
//                   X1  Y1  Z1
//     1  0.00  12.1  -3.2  40.5
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "framework/recordings/cells.h"
#include "framework/recordings/recordings.h"

namespace talus {
namespace {

class TrcReader {
 public:
  TrcReader(std::string_view text, const std::string& file) : lines_(text, file) {
    recordings_.file = file;
  }

  Recordings read() {
    next("the line PathFileType");
    if (cells_[0].text != "PathFileType")
      fail(cells_[0], quoted(cells_[0].text) + " at the start of a marker file", "PathFileType");
    facts();
    headings();
    while (next_row()) row();
    if (recordings_.rows() == 0)
      throw InputError(Place{recordings_.file, recordings_.header_line},
                       "there are no frames below the header", "one row per frame");
    if (frames_ && *frames_ != static_cast<double>(recordings_.rows()))
      throw InputError(
          Place{recordings_.file, facts_line_},
          fmt::format("NumFrames is {}, but there are {} frames", *frames_, recordings_.rows()),
          "a complete file, or the number of frames there are");
    return std::move(recordings_);
  }

 private:
  [[noreturn]] void fail(const Cell& cell, const std::string& found, const std::string& expected,
                         const std::string& suggestion = {}) const {
    throw InputError(lines_.place(cell.offset), found, expected, suggestion);
  }

  void next(const std::string& expected) {
    if (!lines_.next())
      throw InputError(Place{recordings_.file, lines_.number()}, "the file ends here", expected);
    require_utf8(lines_);
    split_cells(lines_, '\t', cells_);
  }

  // DataRate ... Units and their values
  void facts() {
    next("the line DataRate ... Units");
    const std::vector<Cell> names = cells_;
    const Lines names_line = lines_;
    next("the values of DataRate ... Units");
    facts_line_ = lines_.number();
    const auto fact = [&](std::string_view name) -> const Cell* {
      for (std::size_t i = 0; i < names.size() && i < cells_.size(); ++i)
        if (names[i].text == name) return &cells_[i];
      return nullptr;
    };
    const Cell* units = fact("Units");
    if (!units)
      throw InputError(names_line.place(0), "there is no 'Units' in the header of a marker file",
                       "Units, with a length (mm, m, ...) below it");
    const std::optional<Unit> unit = parse_unit(units->text);
    if (!unit || unit->dimension != length)
      fail(*units, quoted(units->text) + " is not a unit of length", describe(length),
           nearest_unit(units->text, length));
    unit_ = *unit;
    if (const Cell* frames = fact("NumFrames")) frames_ = read_number(frames->text);
    if (const Cell* markers = fact("NumMarkers")) markers_ = read_number(markers->text);
  }

  void headings() {
    next("the line Frame# Time and the markers' names");
    recordings_.header_line = lines_.number();
    if (cells_.size() < 3 || !cells_[0].text.starts_with("Frame") || cells_[1].text != "Time")
      fail(cells_[0], quoted(lines_.line()) + " in place of the markers' names",
           "Frame#, Time and the markers' names");
    add("pose", Unit{}, cells_[0]);
    add("time", *parse_unit("s"), cells_[1]);
    for (std::size_t i = 2; i < cells_.size(); ++i) {
      const Cell& cell = cells_[i];
      const bool starts_marker = (i - 2) % 3 == 0;
      if (starts_marker == !cell.text.empty()) {
        if (!starts_marker) continue;
        for (const char* axis : {".x", ".y", ".z"}) add(std::string(cell.text) + axis, unit_, cell);
      } else if (!cell.text.empty()) {
        fail(cell, fmt::format("the marker {} stands above the wrong column", quoted(cell.text)),
             "a marker's name and two empty cells");
      }
    }
    const std::size_t found = (recordings_.columns.size() - 2) / 3;
    if (found == 0) fail(cells_[0], "there are no markers", "a marker's name and two empty cells");
    if (markers_ && *markers_ != static_cast<double>(found))
      throw InputError(Place{recordings_.file, facts_line_},
                       fmt::format("NumMarkers is {}, but there are {} names", *markers_, found),
                       "as many names as markers");
    next("the line X1 Y1 Z1 ...");
  }

  void add(const std::string& name, const Unit& unit, const Cell& cell) {
    if (recordings_.find(name))
      fail(cell, fmt::format("a second marker {}", quoted(cell.text)), "a name of its own");
    recordings_.columns.push_back({name, unit, {}, lines_.place(cell.offset)});
  }

  bool next_row() {
    while (lines_.next())
      if (!trim_blanks(lines_.line()).empty()) {
        split_cells(lines_, '\t', cells_);
        return true;
      }
    return false;
  }

  void row() {
    const std::size_t n = recordings_.columns.size();
    while (cells_.size() > n && cells_.back().text.empty()) cells_.pop_back();
    if (cells_.size() != n)
      fail(cells_.size() > n ? cells_[n] : Cell{{}, lines_.line().size()},
           fmt::format("the row has {} cells", cells_.size()),
           fmt::format("{} cells: frame, time and three for each of {} markers", n, (n - 2) / 3));
    for (std::size_t i = 0; i < n; ++i) {
      RecordedColumn& column = recordings_.columns[i];
      double value = std::numeric_limits<double>::quiet_NaN();
      // A marker out of sight is an empty cell or NaN.
      const bool missing =
          cells_[i].text.empty() || cells_[i].text == "NaN" || cells_[i].text == "nan";
      if (!missing) {
        const std::optional<double> number = read_number(cells_[i].text);
        if (!number)
          fail(cells_[i],
               fmt::format("{} in the column '{}' is not a number", quoted(cells_[i].text),
                           column.name),
               "a number, or an empty cell where the value is missing");
        value = column.unit.factor * *number;
      }
      column.values.push_back(value);
    }
    recordings_.lines.push_back(lines_.number());
  }

  Lines lines_;
  Recordings recordings_;
  std::vector<Cell> cells_;
  Unit unit_;
  std::optional<double> frames_, markers_;
  int facts_line_ = 0;
};

}  // namespace

Recordings parse_trc(std::string_view text, const std::string& file) {
  return TrcReader(require_text(text, file, "a marker file, starting with PathFileType"), file)
      .read();
}

}  // namespace talus
