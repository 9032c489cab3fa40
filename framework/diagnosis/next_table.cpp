#include "framework/diagnosis/next_table.h"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

// Of the recordings' columns, those that whoever records can choose, beside the coordinates.
bool chosen(const Program& program, const std::string& name) {
  const bool payload = std::any_of(program.payloads.begin(), program.payloads.end(),
                                   [&](const Payload& p) { return p.column == name; });
  const bool group = std::any_of(
      program.unknowns.begin(), program.unknowns.end(),
      [&](const Unknown& u) { return std::find(u.per.begin(), u.per.end(), name) != u.per.end(); });
  return payload || group || name.starts_with("approach_");
}

void head(Recordings& table, const Program& program, const Pool& pool) {
  auto column = [&](const std::string& name, Dimension dimension) {
    Unit unit = program.units.of(dimension);
    if (dimension == number) unit.text.clear();  // no bracket in the header
    table.columns.push_back({name, unit, {}, {}});
  };
  column("pose", number);
  for (const Coordinate& c : pool.coordinates) column(c.column, c.dimension);
  for (const RecordedColumn& c : pool.recordings.columns)
    if (chosen(program, c.name) && !table.find(c.name))
      table.columns.push_back({c.name, c.unit, {}, {}});
}

}  // namespace

void add_to_table(Recordings& table, const Program& program, const Pool& pool,
                  const std::vector<double>& coordinates, std::size_t row) {
  if (table.columns.empty()) head(table, program, pool);
  std::size_t at = 0;
  table.columns[at++].values.push_back(static_cast<double>(table.rows() + 1));
  for (const double v : coordinates) {  // no more digits than can be set
    RecordedColumn& c = table.columns[at++];
    c.values.push_back(c.unit.factor * (std::round(v / c.unit.factor * 1e6) / 1e6));
  }
  for (; at < table.columns.size(); ++at)
    table.columns[at].values.push_back(pool.recordings.find(table.columns[at].name)->values[row]);
  table.lines.push_back(static_cast<int>(table.rows()) + 2);
}

}  // namespace talus
