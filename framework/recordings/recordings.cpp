#include "framework/recordings/recordings.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "framework/model/quantity.h"

namespace talus {

const RecordedColumn* Recordings::find(std::string_view name) const {
  for (const RecordedColumn& column : columns)
    if (column.name == name) return &column;
  return nullptr;
}

// "an angle (deg, rad, mrad)" as a column: "an angle, as theta1[deg] or theta1[rad]"
static std::string column_of(std::string_view name, Dimension dimension) {
  if (dimension == number) return "a plain number: the column " + std::string(name);
  const std::string what = describe(dimension);
  std::vector<std::string> names = unit_names(dimension);
  if (names.empty()) names = {UnitSystem{}.of(dimension).text};
  if (names.size() > 2) names.resize(2);
  for (std::string& unit : names) unit = std::string(name) + "[" + unit + "]";
  return what.substr(0, what.find(" (")) + ": the column " + join(names, " or ");
}

const RecordedColumn& Recordings::get(std::string_view name, Dimension dimension) const {
  const RecordedColumn* column = find(name);
  if (!column) {
    std::vector<std::string> names;
    for (const RecordedColumn& c : columns) names.push_back(c.name);
    const std::string near = nearest(name, names);
    if (names.size() > 40) names.resize(40), names.push_back("...");
    throw InputError(Place{file, header_line}, "there is no column '" + std::string(name) + "'",
                     "one of: " + join(names), near);
  }
  if (column->unit.dimension == dimension) return *column;
  const std::string what = describe(column->unit.dimension);
  const std::string found = column->unit.dimension == number && column->unit.text.empty()
                                ? "the column '" + column->name + "' has no unit"
                                : "the column '" + column->name + "' is in " + column->unit.text +
                                      ", " + what.substr(0, what.find(" ("));
  throw InputError(column->place, found, column_of(name, dimension));
}

Recordings read_recordings(const std::string& file) {
  const std::filesystem::path path(file);
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw InputError(Place{file}, "this is a folder", "a file of recordings (CSV or TRC)");
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw InputError(Place{file},
                     std::filesystem::exists(path, ignored) ? "the file cannot be read"
                                                            : "there is no such file",
                     "a file of recordings (CSV or TRC)");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".trc" ? parse_trc(text, file) : parse_recordings(text, file);
}

std::string write_recordings(const Recordings& recordings) {
  std::string text;
  const auto separate = [&](std::size_t i) {
    if (i > 0) text += ',';
  };
  const std::size_t n = recordings.columns.size();
  for (std::size_t i = 0; i < n; ++i) {
    separate(i);
    const RecordedColumn& column = recordings.columns[i];
    text += column.name;
    if (!column.unit.text.empty()) text += "[" + column.unit.text + "]";
  }
  if (recordings.use) separate(n), text += "use";
  text += '\n';
  for (std::size_t row = 0; row < recordings.rows(); ++row) {
    for (std::size_t i = 0; i < n; ++i) {
      separate(i);
      const RecordedColumn& column = recordings.columns[i];
      if (const double value = column.values[row]; !std::isnan(value))
        text += shortest(value, column.unit);
    }
    if (recordings.use) separate(n), text += (*recordings.use)[row] ? "fit" : "check";
    text += '\n';
  }
  return text;
}

}  // namespace talus
