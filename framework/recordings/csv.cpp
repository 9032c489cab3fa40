#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "framework/recordings/cells.h"
#include "framework/recordings/recordings.h"

namespace talus {
namespace {

const char* const a_header = "a header row, such as pose,theta1[deg],E.x[mm]";

class CsvReader {
 public:
  CsvReader(std::string_view text, const std::string& file)
      : lines_(text, file),
        size_(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'))) {
    recordings_.file = file;
  }

  Recordings read() {
    if (!next_row()) fail(0, "there are only comments", a_header);
    header();
    while (next_row()) row();
    if (recordings_.rows() == 0)
      throw InputError(Place{recordings_.file, recordings_.header_line},
                       "there are no rows below the header", "one row per pose");
    return std::move(recordings_);
  }

 private:
  [[noreturn]] void fail(std::size_t offset, const std::string& found, const std::string& expected,
                         const std::string& suggestion = {}) const {
    throw InputError(lines_.place(offset), found, expected, suggestion);
  }

  // To the next line that is neither a comment nor blank.
  bool next_row() {
    while (lines_.next()) {
      const std::size_t first = lines_.line().find_first_not_of(" \t,");
      if (first != std::string_view::npos && !trim_blanks(lines_.line()).starts_with('#'))
        return true;
    }
    return false;
  }

  void header() {
    require_utf8(lines_);
    recordings_.header_line = lines_.number();
    const std::string_view line = lines_.line();
    if (line.find(',') == std::string_view::npos)
      for (const auto& [separator, name] : {std::pair{';', "';'"}, {'\t', "a tab"}})
        if (const std::size_t at = line.find(separator); at != std::string_view::npos)
          fail(at, fmt::format("the cells are separated by {}", name),
               "',' between cells and '.' before decimals");
    split_cells(lines_, ',', cells_);
    if (std::all_of(cells_.begin(), cells_.end(),
                    [](const Cell& c) { return c.text.empty() || read_number(c.text); }))
      fail(cells_[0].offset, "the first row holds numbers", a_header);
    for (const Cell& cell : cells_) heading(cell);
    for (RecordedColumn& column : recordings_.columns) column.values.reserve(size_);
    recordings_.lines.reserve(size_);
  }

  // name or name[unit]
  void heading(const Cell& cell) {
    const std::size_t open = cell.text.find('[');
    const std::string_view name = trim_blanks(cell.text.substr(0, open));
    if (name.empty())
      fail(cell.offset, fmt::format("column {} has no name", names_.size() + 1),
           "a name, such as theta1[deg]");
    if (const std::size_t at = name.find_first_of(",;\"\t"); at != std::string_view::npos)
      fail(cell.offset + at,
           fmt::format("{} in the column's name {}", quoted(name.substr(at, 1)), quoted(name)),
           "',' between cells and none of , ; \" in names");
    if (const auto first = std::find(names_.begin(), names_.end(), name); first != names_.end())
      fail(cell.offset, fmt::format("a second column {}", quoted(name)),
           fmt::format("a name of its own (column {} has this one)", first - names_.begin() + 1));
    names_.emplace_back(name);
    if (open == std::string_view::npos && cell.text.ends_with(')')) parenthesis(cell);
    if (open == std::string_view::npos && cell.text.find(']') != std::string_view::npos)
      fail(cell.offset + cell.text.find(']'), "']' without '['", "a name, such as theta1[deg]");
    Unit unit;
    if (open != std::string_view::npos) unit = unit_in_brackets(cell, open, name);
    if (name != "use") {
      recordings_.columns.push_back({std::string(name), unit, {}, lines_.place(cell.offset)});
      return;
    }
    if (open != std::string_view::npos)
      fail(cell.offset + open, "a unit on the column 'use'",
           "the column use, with the words fit and check");
    use_ = names_.size() - 1;
    recordings_.use.emplace();
  }

  Unit unit_in_brackets(const Cell& cell, std::size_t open, std::string_view name) const {
    const std::size_t close = cell.text.find(']', open);
    if (close == std::string_view::npos)
      fail(cell.offset + open, fmt::format("the bracket in {} is not closed", quoted(cell.text)),
           fmt::format("{}[unit]", name));
    if (close + 1 != cell.text.size())
      fail(cell.offset + close + 1,
           fmt::format("{} after the unit", quoted(cell.text.substr(close + 1))),
           "',' or the end of the line");
    const std::string_view text = trim_blanks(cell.text.substr(open + 1, close - open - 1));
    if (std::optional<Unit> unit = parse_unit(text)) return *unit;
    fail(cell.offset + open + 1, text.empty() ? "an empty unit" : quoted(text) + " is not a unit",
         "one of: " + join(unit_names()) + ", 1, or a product such as N*mm", nearest_unit(text));
  }

  // theta1(deg) instead of theta1[deg]
  void parenthesis(const Cell& cell) const {
    const std::size_t open = cell.text.rfind('(');
    if (open == std::string_view::npos || open == 0) return;
    const std::string_view text = cell.text.substr(open + 1, cell.text.size() - open - 2);
    const std::string near = parse_unit(text) ? std::string(text) : nearest_unit(text);
    if (!near.empty())
      fail(cell.offset + open,
           fmt::format("the unit in {} is in round brackets", quoted(cell.text)), "square brackets",
           fmt::format("{}[{}]", trim_blanks(cell.text.substr(0, open)), near));
  }

  void row() {
    split_cells(lines_, ',', cells_);
    if (cells_.size() != names_.size()) wrong_length();
    std::size_t i = 0;
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      if (k == use_) {
        use(cells_[k]);
        continue;
      }
      RecordedColumn& column = recordings_.columns[i++];
      double value = std::numeric_limits<double>::quiet_NaN();
      if (!cells_[k].text.empty()) {
        const std::optional<double> number = read_number(cells_[k].text);
        if (!number) wrong_number(cells_[k], column);
        value = column.unit.factor * *number + column.unit.offset;
      }
      column.values.push_back(value);
    }
    recordings_.lines.push_back(lines_.number());
  }

  void use(const Cell& cell) {
    if (cell.text != "fit" && cell.text != "check")
      fail(cell.offset,
           (cell.text.empty() ? "an empty cell" : quoted(cell.text)) + " in the column 'use'",
           "fit or check", nearest(cell.text, {"fit", "check"}));
    recordings_.use->push_back(cell.text == "fit");
  }

  [[noreturn]] void wrong_length() const {
    const std::size_t n = names_.size();
    const bool semicolons = lines_.line().find(';') != std::string_view::npos;
    std::string expected =
        fmt::format("{} cells, as in the header of line {}", n, recordings_.header_line);
    if (semicolons) expected += ", separated by ','";
    if (cells_.size() > n) expected += "; a decimal comma makes two cells of one number";
    fail(cells_.size() > n ? cells_[n].offset : lines_.line().size(),
         fmt::format("the row has {} cell{}", cells_.size(), cells_.size() == 1 ? "" : "s"),
         expected);
  }

  [[noreturn]] void wrong_number(const Cell& cell, const RecordedColumn& column) const {
    std::string expected = "a number, or an empty cell where the value is missing", near;
    std::string with_point(cell.text);
    std::replace(with_point.begin(), with_point.end(), ',', '.');
    const std::size_t blank = cell.text.find_first_of(" \t");
    const std::string_view minus = "−";
    if (with_point != cell.text && read_number(with_point))
      expected = "a decimal point", near = with_point;
    else if (cell.text.find(';') != std::string_view::npos)
      expected = "',' between cells";
    else if (cell.text.starts_with(minus) && read_number(cell.text.substr(minus.size())))
      expected = "an ASCII minus sign", near = "-" + std::string(cell.text.substr(minus.size()));
    else if (blank != std::string_view::npos && read_number(cell.text.substr(0, blank)) &&
             parse_unit(cell.text.substr(blank)))
      expected = fmt::format("the unit in the header, as {}[{}]", column.name,
                             trim_blanks(cell.text.substr(blank)));
    fail(cell.offset,
         fmt::format("{} in the column '{}' is not a number", quoted(cell.text), column.name),
         expected, near);
  }

  Lines lines_;
  std::size_t size_;  // rows to expect
  Recordings recordings_;
  std::vector<std::string> names_;  // of all columns, `use` among them
  std::size_t use_ = std::string::npos;
  std::vector<Cell> cells_;
};

}  // namespace

Recordings parse_recordings(std::string_view text, const std::string& file) {
  return CsvReader(require_text(text, file, a_header), file).read();
}

}  // namespace talus
