#include "framework/diagnosis/corrections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

struct Factor {
  double by;
  const char* words;  // what the values are in truth, or how they are off
};
constexpr double per_radian = 57.29577951308232;
const Factor of_angles[] = {{per_radian, "in rad although the header says deg"},
                            {1 / per_radian, "in deg although the header says rad"}};
const Factor of_lengths[] = {{1000, "1000 times too small (m for mm?)"},
                             {0.001, "1000 times too large (um or mm for m?)"},
                             {25.4, "25.4 times too small (inches for mm?)"},
                             {1 / 25.4, "25.4 times too large (mm for inches?)"},
                             {10, "ten times too small (cm for mm?)"},
                             {0.1, "ten times too large (mm for cm?)"}};

// A sensor's column or a feature's, and whose it is.
struct Used {
  std::string column, owner;
  Dimension dimension;
};

std::string list(const std::vector<Used>& used) {
  std::vector<std::string> names;
  for (const Used& u : used) names.push_back(u.column);
  return join(names);
}
std::string owners(const std::vector<Used>& used) {
  std::vector<std::string> names;
  for (const Used& u : used)
    if (std::find(names.begin(), names.end(), u.owner) == names.end()) names.push_back(u.owner);
  return join(names);
}

class Hypotheses {
 public:
  std::vector<Correction> all;

  void exchanged(const std::vector<Used>& columns, const std::vector<std::size_t>& order) {
    Correction c{"swapped-columns"};
    std::vector<Used> moved;
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (order[i] != i) {
        c.columns.push_back({columns[i].column, columns[order[i]].column});
        moved.push_back(columns[i]);
      }
    c.where = owners(moved);
    c.statement = fmt::format("the columns {} are {}", list(moved),
                              moved.size() == 2 ? "exchanged" : "in another order");
    all.push_back(std::move(c));
  }
  void reversed(const Used& u) {
    all.push_back({"wrong-sign",
                   u.owner,
                   fmt::format("the column {} has the wrong sign", u.column),
                   {{u.column, u.column, -1}}});
  }
  void scaled(const std::vector<Used>& columns, bool measured) {
    if (columns.empty()) return;
    auto add = [&](const Factor& f) {
      Correction c{"wrong-unit", owners(columns),
                   fmt::format("the values of {} are {}", list(columns), f.words)};
      for (const Used& u : columns) c.columns.push_back({u.column, u.column, f.by});
      c.of_measurements = measured;
      all.push_back(std::move(c));
    };
    if (columns[0].dimension == angle)
      for (const Factor& f : of_angles) add(f);
    if (columns[0].dimension == length)
      for (const Factor& f : of_lengths) add(f);
  }
  // q: the columns qw, qx, qy, qz.
  void quaternion(const std::vector<Used>& q) {
    auto add = [&](const char* words, std::array<int, 4> from, std::array<double, 4> sign) {
      Correction c{"quaternion-order", q[0].owner,
                   fmt::format("the quaternion of {} is {}", q[0].owner, words)};
      for (std::size_t i = 0; i < 4; ++i)
        c.columns.push_back({q[i].column, q[from[i]].column, sign[i]});
      all.push_back(std::move(c));
    };
    add("in the order x, y, z, w", {3, 0, 1, 2}, {1, 1, 1, 1});
    add("of the inverse rotation (conjugate)", {0, 1, 2, 3}, {1, -1, -1, -1});
    add("in the order x, y, z, w and of the inverse rotation", {3, 0, 1, 2}, {1, -1, -1, -1});
  }
};

bool ends_with(const std::string& name, const char* ending) {
  const std::string e = ending;
  return name.size() >= e.size() && name.compare(name.size() - e.size(), e.size(), e) == 0;
}

// The sensors' columns that this table has; one that several sensors read counts once.
std::vector<Used> readings_of(const Program& program, const Recordings& recordings) {
  std::vector<Used> used;
  for (const Reading& r : program.readings)
    if (recordings.find(r.column) &&
        std::none_of(used.begin(), used.end(), [&](const Used& u) { return u.column == r.column; }))
      used.push_back({r.column, r.sensor, r.dimension});
  return used;
}

std::vector<Used> measured_of(const Program& program, const Feature& f,
                              const Recordings& recordings) {
  std::vector<Used> used;
  for (int c : f.columns)
    if (recordings.find(program.columns[c].name))
      used.push_back({program.columns[c].name, f.name, program.columns[c].dimension});
  return used;
}

void of_readings(const std::vector<Used>& readings, Hypotheses& h) {
  for (std::size_t i = 0; i < readings.size(); ++i) {
    for (std::size_t j = i + 1; j < readings.size(); ++j)
      if (readings[i].dimension == readings[j].dimension)
        h.exchanged({readings[i], readings[j]}, {1, 0});
    if (readings[i].dimension == angle || readings[i].dimension == length) h.reversed(readings[i]);
    h.scaled({readings[i]}, false);
  }
  for (Dimension dimension : {angle, length}) {
    std::vector<Used> same;
    for (const Used& u : readings)
      if (u.dimension == dimension) same.push_back(u);
    if (same.size() > 1) h.scaled(same, false);
  }
}

void of_feature(const std::vector<Used>& columns, Hypotheses& h) {
  std::vector<Used> quaternion;
  for (const char* part : {".qw", ".qx", ".qy", ".qz"})
    for (const Used& u : columns)
      if (ends_with(u.column, part)) quaternion.push_back(u);
  if (quaternion.size() == 4) h.quaternion(quaternion);
  for (Dimension dimension : {length, angle, number}) {
    std::vector<Used> same;
    for (const Used& u : columns)
      if (u.dimension == dimension &&
          std::none_of(quaternion.begin(), quaternion.end(),
                       [&](const Used& q) { return q.column == u.column; }))
        same.push_back(u);
    if (same.size() == 2) h.exchanged(same, {1, 0});
    if (same.size() == 3)
      for (const std::vector<std::size_t>& order :
           {std::vector<std::size_t>{1, 0, 2}, {2, 1, 0}, {0, 2, 1}, {1, 2, 0}, {2, 0, 1}})
        h.exchanged(same, order);
    if (same.size() > 1)
      for (const Used& u : same) h.reversed(u);
    h.scaled(same, true);
  }
}

}  // namespace

std::vector<Correction> column_corrections(const Program& program, const Recordings& recordings) {
  Hypotheses h;
  of_readings(readings_of(program, recordings), h);
  std::vector<Used> lengths;
  for (const Feature& f : program.features) {
    const std::vector<Used> columns = measured_of(program, f, recordings);
    of_feature(columns, h);
    for (const Used& u : columns)
      if (u.dimension == length) lengths.push_back(u);
  }
  if (program.features.size() > 1) h.scaled(lengths, true);
  return h.all;
}

Correction row_correction(const Program& program, const Recordings& recordings, int shift,
                          std::size_t from) {
  Correction c{"shifted-rows"};
  std::vector<Used> all;
  for (const Feature& f : program.features)
    for (const Used& u : measured_of(program, f, recordings)) {
      all.push_back(u);
      c.columns.push_back({u.column, u.column});
    }
  c.where = owners(all);
  c.shift = shift;
  c.from = from;
  std::string since;
  if (from > 0) {
    const RecordedColumn* pose = recordings.find("pose");
    since = fmt::format(" from pose {:g} on",
                        pose ? pose->values[from] : static_cast<double>(from + 1));
  }
  c.statement = fmt::format(
      "the measurements of {} stand {} row{} too {}{}: those beside one setting belong to {}",
      c.where, std::abs(shift), std::abs(shift) == 1 ? "" : "s", shift > 0 ? "late" : "early",
      since, shift > 0 ? "an earlier one" : "a later one");
  return c;
}

Recordings corrected(const Recordings& recordings, const Correction& correction) {
  Recordings result = recordings;
  const auto n = static_cast<long>(recordings.rows());
  for (const Correction::Column& c : correction.columns) {
    const RecordedColumn* source = recordings.find(c.source);
    const auto target =
        std::find_if(result.columns.begin(), result.columns.end(),
                     [&](const RecordedColumn& column) { return column.name == c.target; });
    for (long k = static_cast<long>(correction.from); k < n; ++k) {
      const long other = k + correction.shift;
      const bool there = other >= static_cast<long>(correction.from) && other < n;
      target->values[k] =
          there ? c.factor * source->values[other] : std::numeric_limits<double>::quiet_NaN();
    }
  }
  return result;
}

}  // namespace talus
