#include "framework/diagnosis/next_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/calibration/load_columns.h"

namespace talus {
namespace {

// Of the recordings' columns, those that whoever records can choose, beside the coordinates.
bool chosen(const Program& program, const std::string& name) {
  const bool payload = std::any_of(program.payloads.begin(), program.payloads.end(),
                                   [&](const Payload& p) { return p.column == name; });
  const bool group = std::any_of(
      program.unknowns.begin(), program.unknowns.end(),
      [&](const Unknown& u) { return std::find(u.per.begin(), u.per.end(), name) != u.per.end(); });
  const bool gravity =
      std::find(gravity_columns.begin(), gravity_columns.end(), name) != gravity_columns.end();
  return payload || group || gravity || name.starts_with("approach_");
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

double pose_number(const Recordings& recordings, std::size_t row) {
  const RecordedColumn* c = recordings.find("pose");
  return c && !std::isnan(c->values[row]) ? c->values[row] : static_cast<double>(row + 1);
}

std::string how_to_record(const Recordings& table, const Program& program, const Pool& pool,
                          const Origin& origin, const std::set<std::string>& sides) {
  std::vector<std::string> words;
  const std::size_t row = table.rows() - 1;
  if (origin.again >= 0) {
    const double which = pose_number(pool.recordings, static_cast<std::size_t>(origin.again));
    words.push_back(
        fmt::format("pose {:g} again{}", which, origin.other_side ? ", from the other side" : ""));
  }
  std::vector<std::string> above, below;
  for (const RecordedColumn& c : table.columns)
    if (c.name.starts_with("approach_") && sides.contains(c.name.substr(9)))
      (c.values[row] > 0 ? below : above).push_back(c.name.substr(9));
  std::sort(above.begin(), above.end());
  std::sort(below.begin(), below.end());
  if (!below.empty()) words.push_back(join(below) + " from below");
  if (!above.empty()) words.push_back(join(above) + " from above");
  std::set<std::string> hung;
  for (const Payload& p : program.payloads) {
    const RecordedColumn* c = p.column.empty() ? nullptr : table.find(p.column);
    if (!c || !hung.insert(p.column).second) continue;
    const std::string what = program.payloads.size() > 1 ? p.column : "payload";
    words.push_back(c->values[row] > 0 ? fmt::format("with {:.4g} kg", c->values[row]) +
                                             (what == "payload" ? "" : " of " + what)
                                       : "without " + what);
  }
  const RecordedColumn* x = table.find(gravity_columns[0]);
  if (origin.mounting >= 0)
    words.push_back(pool.mountings[static_cast<std::size_t>(origin.mounting)].words);
  else if (x && !std::isnan(x->values[row]))
    words.push_back(fmt::format("gravity along {:.2g}, {:.2g}, {:.2g}", x->values[row],
                                table.find(gravity_columns[1])->values[row],
                                table.find(gravity_columns[2])->values[row]));
  return join(words);
}

}  // namespace talus
