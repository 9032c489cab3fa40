#include "framework/calibration/circumstances.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/calibration/load_columns.h"
#include "framework/kinematics/axis_place.h"
#include "framework/kinematics/covariates.h"
#include "framework/kinematics/pose_values.h"

namespace talus {
namespace {

constexpr double kPause = 30;  // s from pose to pose
constexpr std::string_view kApproach = "approach_";

// The number by which a joint turns or slides: the amount of the first of its motions that a
// coordinate moves. Where that is a matrix, the coordinate itself.
Expr amount_of_move(const Program& program, const Frame& frame) {
  const std::vector<bool> coordinate = coordinate_slots(program);
  auto coordinate_in = [&](const Expr& e) {
    for (int slot : support(e))
      if (coordinate[slot]) return slot;
    return -1;
  };
  for (const Motion<Expr>& m : frame.moving.motions()) {
    if (m.kind != Motion<Expr>::Kind::matrix) {
      if (coordinate_in(m.amount) >= 0) return m.amount;
      continue;
    }
    for (const auto& row : m.rotation)
      for (const Expr& e : row)
        if (const int slot = coordinate_in(e); slot >= 0) return Expr::leaf(*program.tape, slot);
  }
  return Expr(0);
}

std::vector<double> approaches(const Program& program, const std::string& joint,
                               const Settings& settings) {
  const auto frame = program.frame_index.find(joint);
  const Expr amount = frame == program.frame_index.end()
                          ? Expr(0)
                          : amount_of_move(program, program.frames[frame->second]);
  TapeValues value(*program.tape, {amount.node_on(*program.tape)});
  std::vector<double> rest;
  for (const Coordinate& c : coordinates(program)) rest.push_back(c.rest);
  double before = value(slots_at(program, rest))[0], sense = 0;
  std::vector<double> result;
  for (const auto& pose : settings.poses) {
    const double now = value(slots_at(program, pose))[0];
    if (now != before) sense = now > before ? 1 : -1;
    if (!std::isnan(now)) before = now;
    result.push_back(sense);
  }
  return result;
}

// The columns by which rows are grouped, that no sensor has: those of shared unknowns, then those
// of what is held out together.
std::vector<std::string> group_columns(const Program& program) {
  std::vector<std::string> names;
  auto add = [&](const std::string& name) {
    const bool read = std::any_of(program.readings.begin(), program.readings.end(),
                                  [&](const Reading& r) { return r.column == name; });
    if (!read && name != "pose" && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  };
  for (const Unknown& u : program.unknowns)
    for (const std::string& name : u.per) add(name);
  for (const std::string& name : program.settings.groups) add(name);
  return names;
}

// Recorded columns that the program's covariates are or follow from, payloads first to last.
std::vector<std::pair<std::string, Dimension>> wanted(const Program& program) {
  std::set<std::string> names;
  bool loads = false;
  for (const Reading& r : program.readings) {
    if (!r.covariate) continue;
    if (!is_derived(r.column)) names.insert(r.column);
    if (r.column == "since" || r.column.starts_with("rate:")) names.insert("time");
    if (r.column.starts_with("load:"))
      loads = true;
    else if (is_derived(r.column))
      names.insert("session");
  }
  std::vector<std::pair<std::string, Dimension>> result;
  if (names.contains("time")) result.emplace_back("time", duration);
  if (names.contains("session")) result.emplace_back("session", number);
  if (names.contains("temperature")) result.emplace_back("temperature", temperature);
  if (loads)
    for (const Payload& p : program.payloads)
      if (!p.column.empty() && std::none_of(result.begin(), result.end(), [&](const auto& known) {
            return known.first == p.column;
          }))
        result.emplace_back(p.column, mass);
  for (const std::string& name : names)
    if (name.starts_with(kApproach)) result.emplace_back(name, number);
  return result;
}

bool is_coordinate(const Program& program, const std::string& column) {
  return std::any_of(program.readings.begin(), program.readings.end(),
                     [&](const Reading& r) { return !r.covariate && r.column == column; });
}

// All that a table of poses may say beside readings and unknowns.
std::vector<std::pair<std::string, Dimension>> circumstances(const Program& program) {
  std::vector<std::pair<std::string, Dimension>> result = {
      {"time", duration}, {"session", number}, {"temperature", temperature}};
  for (const Payload& p : program.payloads) result.emplace_back(p.column, mass);
  for (const Frame& f : program.frames)
    result.emplace_back(std::string(kApproach) + f.name, number);
  for (const char* name : gravity_columns) result.emplace_back(name, number);
  return result;
}

}  // namespace

bool depends_on_loads(const Program& program) {
  return std::any_of(program.readings.begin(), program.readings.end(),
                     [](const Reading& r) { return r.covariate && r.column.starts_with("load:"); });
}

Recordings with_derived(const Program& program, const Recordings& recordings,
                        std::span<const double> parameters) {
  std::vector<double> nominal;
  if (parameters.empty()) {
    for (const Parameter& p : program.parameters) nominal.push_back(p.nominal.value);
    parameters = nominal;
  }
  parameters = parameters.first(program.parameters.size());
  Recordings result =
      depends_on_loads(program) ? with_loads(program, recordings, parameters) : recordings;
  result = with_covariates(program, std::move(result));
  for (const Reading& r : program.readings) {
    if (!r.covariate || !is_derived(r.column) || result.find(r.column)) continue;
    const std::string what = r.column.substr(r.column.find(':') + 1);
    if (r.column.starts_with("load:"))
      throw InputError(
          r.place,
          fmt::format("the load of '{}' is not known", what.substr(0, what.find_last_of('.'))),
          "<gravity>, masses of the links, and a joint that a sensor reads");
    if (!r.column.starts_with("travel:")) result.get("time", duration);
    if (r.column != "since")
      for (const Reading& sensor : program.readings)
        if (sensor.column == what) result.get(what, sensor.dimension);
  }
  return result;
}

Settings with_circumstances(const Program& program, Settings settings, const Recordings* table) {
  const std::vector<std::string> groups = group_columns(program);
  const bool needed =
      !groups.empty() || std::any_of(program.readings.begin(), program.readings.end(),
                                     [](const Reading& r) { return r.covariate; });
  if ((!needed && !table) || !settings.circumstances.empty()) return settings;
  const std::size_t rows = settings.poses.size();
  Recordings made;
  for (std::size_t k = 0; k < rows; ++k) made.lines.push_back(static_cast<int>(k) + 2);
  auto add = [&](const std::string& name, Dimension dimension, std::vector<double> values) {
    Unit unit = program.units.of(dimension);
    if (dimension == number) unit.text.clear();
    made.columns.push_back({name, unit, std::move(values), {}});
  };
  auto numbers = [&](double first, double step) {
    std::vector<double> values;
    for (std::size_t k = 0; k < rows; ++k) values.push_back(first + step * static_cast<double>(k));
    return values;
  };
  auto set = [&](std::size_t reading, const std::vector<double>& values) {
    for (std::size_t k = 0; k < rows; ++k) settings.poses[k][reading] = values[k];
  };
  for (std::size_t i = 0; i < program.readings.size(); ++i)
    if (program.readings[i].covariate && program.readings[i].column == "pose" &&
        !(table && table->find("pose")))
      set(i, numbers(1, 1));

  for (const auto& entry : wanted(program)) {
    const auto& name = entry.first;  // older compilers do not let lambdas capture bindings
    const auto& dimension = entry.second;
    const auto payload = std::find_if(program.payloads.begin(), program.payloads.end(),
                                      [&](const Payload& p) { return p.column == name; });
    if (table && table->find(name))
      add(name, dimension, table->get(name, dimension).values);
    else if (name == "time")
      add(name, dimension, numbers(0, kPause));
    else if (name.starts_with(kApproach))
      add(name, dimension, approaches(program, name.substr(kApproach.size()), settings));
    else
      add(name, dimension,
          numbers(payload == program.payloads.end() ? usual_value(name) : payload->mass, 0));
  }
  if (table)
    for (const auto& [name, dimension] : circumstances(program))  // recorded, whether needed or not
      if (table->find(name) && !made.find(name) && !is_coordinate(program, name))
        add(name, dimension, table->get(name, dimension).values);
  for (const std::string& name : groups) {
    const bool shared =
        std::any_of(program.unknowns.begin(), program.unknowns.end(), [&](const Unknown& u) {
          return std::find(u.per.begin(), u.per.end(), name) != u.per.end();
        });
    if (made.find(name)) continue;
    if (table && table->find(name))
      add(name, number, table->get(name, number).values);
    else
      add(name, number, numbers(1, shared ? 0 : 1));
  }
  settings.circumstances = made.columns;

  for (std::size_t i = 0; i < program.readings.size(); ++i) {  // what they follow from
    const Reading& r = program.readings[i];
    if (r.covariate) continue;
    std::vector<double> values;
    for (const auto& pose : settings.poses) values.push_back(pose[i]);
    add(r.column, r.dimension, std::move(values));
  }
  if (!needed) return settings;
  made = with_derived(program, made);
  for (std::size_t i = 0; i < program.readings.size(); ++i)
    if (program.readings[i].covariate && program.readings[i].column != "pose")
      set(i, made.get(program.readings[i].column, program.readings[i].dimension).values);
  return settings;
}

}  // namespace talus
