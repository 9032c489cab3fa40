#include "framework/recordings/points.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "framework/model/quantity.h"
#include "framework/model/units.h"
#include "framework/recordings/cells.h"

namespace talus {
namespace {

const char* const a_header = "the header pose,feature,x[mm],y[mm],z[mm]";

struct Layout {
  std::array<std::size_t, 3> xyz{};
  std::array<double, 3> factor{};
  std::size_t pose = 0, feature = 0, cells = 0;
};

Layout layout(const Lines& lines, const std::vector<Cell>& cells) {
  Layout result;
  if (cells.size() == 1 && cells[0].text.find_first_of(";\t") != std::string_view::npos)
    throw InputError(lines.place(cells[0].offset), "the cells are not separated by ','", a_header);
  if (read_number(cells[0].text))
    throw InputError(lines.place(0), "the first row holds numbers", a_header);
  result.cells = cells.size();
  const std::vector<std::string> names{"pose", "feature", "x", "y", "z"};
  std::array<bool, 5> found{};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string_view text = cells[i].text;
    const std::size_t open = text.find('[');
    const std::string name(trim_blanks(text.substr(0, open)));
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end())
      throw InputError(lines.place(cells[i].offset),
                       fmt::format("a column {}", talus::quoted(name)), a_header,
                       nearest(name, names));
    const auto which = static_cast<std::size_t>(it - names.begin());
    if (found[which])
      throw InputError(lines.place(cells[i].offset), fmt::format("a second column '{}'", name),
                       a_header);
    found[which] = true;
    if (which < 2) {
      if (open != std::string_view::npos)
        throw InputError(lines.place(cells[i].offset + open),
                         fmt::format("a unit on the column '{}'", name), a_header);
      (which == 0 ? result.pose : result.feature) = i;
      continue;
    }
    const std::size_t close = text.find(']');
    const auto unit = open == std::string_view::npos || close + 1 != text.size()
                          ? std::nullopt
                          : parse_unit(text.substr(open + 1, close - open - 1));
    if (!unit || !(unit->dimension == length))
      throw InputError(lines.place(cells[i].offset),
                       fmt::format("the column {}", talus::quoted(text)),
                       fmt::format("a length: {}[mm]", name));
    result.xyz[which - 2] = i;
    result.factor[which - 2] = unit->factor;
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!found[i])
      throw InputError(lines.place(0), fmt::format("there is no column '{}'", names[i]), a_header);
  return result;
}

}  // namespace

Points parse_points(std::string_view text, const std::string& file) {
  Points points;
  points.file = file;
  Lines lines(require_text(text, points.file, a_header), points.file);
  std::vector<Cell> cells;
  Layout columns;
  while (lines.next()) {
    const std::string_view line = trim_blanks(lines.line());
    if (line.empty() || line.starts_with('#')) continue;
    require_utf8(lines);
    split_cells(lines, ',', cells);
    if (columns.cells == 0) {
      columns = layout(lines, cells);
      continue;
    }
    if (cells.size() != columns.cells)
      throw InputError(lines.place(0), fmt::format("the row has {} cells", cells.size()),
                       fmt::format("{} cells, as in the header", columns.cells));
    auto number = [&](std::size_t i) {
      if (const auto value = read_number(cells[i].text)) return *value;
      throw InputError(lines.place(cells[i].offset),
                       talus::quoted(cells[i].text) + " is not a number", "a number");
    };
    Points::Row row{lines.number(), number(columns.pose), std::string(cells[columns.feature].text)};
    for (int i = 0; i < 3; ++i) row.at[i] = columns.factor[i] * number(columns.xyz[i]);
    points.rows.push_back(std::move(row));
  }
  if (points.rows.empty())
    throw InputError({file, 0, 0}, "there are no points", "one row per probed point");
  return points;
}

Points read_points(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code ignored;
  if (!stream || std::filesystem::is_directory(file, ignored))
    throw InputError({file, 0, 0}, "cannot be read", "a table of probed points (CSV)");
  return parse_points(std::string{std::istreambuf_iterator<char>(stream), {}}, file);
}

std::string write_points(const Points& points) {
  std::string text = "pose,feature,x[mm],y[mm],z[mm]\n";
  for (const Points::Row& row : points.rows)
    text += fmt::format("{},{},{},{},{}\n", shortest(row.pose), row.feature, shortest(row.at[0]),
                        shortest(row.at[1]), shortest(row.at[2]));
  return text;
}

}  // namespace talus
