#include "framework/calibration/inverse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "framework/calibration/identifiability.h"
#include "framework/calibration/problem.h"
#include "framework/kinematics/pose_values.h"

namespace talus {
namespace {

constexpr double kReached = 1e-3;  // weighted residuals of a pose that counts as reached

// The program with the coordinates sorted anew: those with columns are readings, those to be solved
// for unknowns of their pose, the others fixed. Put back at the end, whatever happens.
class Rearranged {
 public:
  Rearranged(Program& program) : program_(program), before_{parts(program)} {}
  ~Rearranged() {
    program_.readings = std::move(before_.readings);
    program_.unknowns = std::move(before_.unknowns);
    program_.parameters = std::move(before_.parameters);
    program_.rows = std::move(before_.rows);
  }
  Rearranged(const Rearranged&) = delete;

 private:
  struct Parts {
    std::vector<Reading> readings;
    std::vector<Unknown> unknowns;
    std::vector<Parameter> parameters;
    std::vector<Row> rows;
  };
  static Parts parts(const Program& p) { return {p.readings, p.unknowns, p.parameters, p.rows}; }
  Program& program_;
  Parts before_;
};

// A reading that is a whole number of turns away moves the linkage to the same place only where its
// sensor says so too: 360 deg of an encoder with slope 1.
double within_half_a_turn(const Program& program, const Reading& reading, double v) {
  const double nearer = std::remainder(v, 360 * deg);
  if (reading.dimension != angle || nearer == v) return v;
  TapeValues value(*program.tape, {reading.value.node_on(*program.tape)});
  std::vector<double> slots(program.slots, 0);
  for (const Parameter& p : program.parameters) slots[p.slot] = p.nominal.value;
  auto at = [&](double x) {
    slots[reading.slot] = x;
    return value(slots)[0];
  };
  return std::abs(std::remainder(at(v) - at(nearer), 360 * deg)) < 1e-9 ? nearer : v;
}

std::vector<Row> rows_with_columns(const Program& program, const Recordings& recordings) {
  std::vector<Row> rows;
  for (const Row& row : program.rows) {
    const std::vector<int>& columns = program.features[row.feature].columns;
    if (std::all_of(columns.begin(), columns.end(),
                    [&](int c) { return recordings.find(program.columns[c].name); }))
      rows.push_back(row);
  }
  return rows;
}

// Which coordinates are to be solved for.
std::vector<bool> wanted(const Program& program, const Recordings& recordings,
                         const std::vector<Coordinate>& list, bool determined) {
  std::set<int> seen;
  const auto support = row_support(program);
  for (const auto& slots : support) seen.insert(slots.begin(), slots.end());
  const std::size_t readings = program.readings.size();
  std::vector<bool> result(list.size());
  bool any_given =
      std::all_of(list.begin(), list.end(), [](const Coordinate& c) { return c.covariate; });
  int count = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const bool given = recordings.find(list[i].column);
    const Unknown* unknown = i < readings ? nullptr : &program.unknowns[i - readings];
    const int slot = unknown ? unknown->slot : program.readings[i].slot;
    any_given |= given && !list[i].covariate;
    if (list[i].covariate) continue;
    result[i] = !given && seen.contains(slot) && !(unknown && !unknown->per.empty()) &&
                (list[i].dimension == angle || list[i].dimension == length);
    count += result[i];
    if (!given && !result[i] && !unknown) recordings.get(list[i].column, list[i].dimension);
  }
  if (!any_given && count == 0) {
    const Coordinate& first =
        *std::find_if(list.begin(), list.end(), [](const Coordinate& c) { return !c.covariate; });
    recordings.get(first.column, first.dimension);
  }
  if (determined && count > static_cast<int>(program.rows.size()))
    throw InputError(
        {recordings.file, recordings.header_line, 0},
        fmt::format("{} coordinates are missing, and the measured features give {} residuals",
                    count, program.rows.size()),
        "columns of the sensors or unknowns, or more measured features");
  return result;
}

// Poses x the coordinates of these numbers.
Eigen::MatrixXd picked(const Settings& settings, const std::vector<std::size_t>& index) {
  Eigen::MatrixXd values(settings.poses.size(), index.size());
  for (std::size_t k = 0; k < settings.poses.size(); ++k)
    for (std::size_t j = 0; j < index.size(); ++j)
      values(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(j)) =
          settings.poses[k][index[j]];
  return values;
}

struct Solution {
  std::vector<double> values;
  double left = std::numeric_limits<double>::infinity();  // norm of the weighted residuals
  bool inside = false;                                    // the coordinates' ranges
  int rows = 0;
};

// Clearly nearer, or as near and inside its ranges.
bool better(const Solution& a, const Solution& b) {
  return a.left < 0.99 * b.left - 1e-9 || (a.inside && !b.inside && a.left < 1.01 * b.left + 1e-9);
}

}  // namespace

Recovered recover(Program& program, const Recordings& recordings, Reach reach, int threads,
                  const Settings* near, int attempts) {
  const std::vector<Coordinate> list = coordinates(program);
  const std::vector<Reading> readings = program.readings;
  const std::vector<Unknown> unknowns = program.unknowns;
  const Rearranged guard(program);
  program.rows = rows_with_columns(program, recordings);
  const std::vector<bool> solve = wanted(program, recordings, list, !near);

  Recovered result;
  std::vector<std::size_t> index;  // of the coordinates solved for
  std::vector<std::pair<double, double>> scatter;
  program.readings.clear();
  program.unknowns.clear();
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Coordinate& c = list[i];
    const bool sensed = i < readings.size();
    const Unknown* unknown = sensed ? nullptr : &unknowns[i - readings.size()];
    const int slot = sensed ? readings[i].slot : unknown->slot;
    if (solve[i]) {
      Unknown u = sensed ? Unknown{c.name, c.dimension, {}, {}, readings[i].place, slot} : *unknown;
      if (reach != Reach::nearest) u.start.tolerance.reset();
      if (sensed && c.range) u.start.value = 0.5 * (c.range->first + c.range->second);
      const double far = c.dimension == angle ? 150 * deg : 3 * typical_size(u.start, c.dimension);
      scatter.push_back(sensed && readings[i].range ? *readings[i].range
                        : u.start.bounds            ? *u.start.bounds
                                         : std::pair(u.start.value - far, u.start.value + far));
      program.unknowns.push_back(std::move(u));
      result.solved.push_back(c.name);
      index.push_back(i);
    } else if (recordings.find(c.column)) {
      program.readings.push_back(sensed ? readings[i]
                                        : Reading{c.name, c.column, c.dimension, 0, {}, {}, slot});
    } else {
      Parameter held{c.name, c.name, "value", c.dimension};
      held.nominal.value = c.rest;
      held.slot = slot;
      program.parameters.push_back(std::move(held));
    }
  }
  for (std::size_t k = 0; k < recordings.rows(); ++k) {
    auto& pose = result.settings.poses.emplace_back();
    for (std::size_t i = 0; i < list.size(); ++i)
      pose.push_back(!solve[i] && recordings.find(list[i].column)
                         ? recordings.get(list[i].column, list[i].dimension).values[k]
                         : list[i].rest);
  }
  result.how.assign(recordings.rows(), Recovered::How::inside);
  if (index.empty()) return result;

  ProblemOptions options;
  options.threads = threads;
  options.only_unknowns = true;
  std::vector<std::size_t> rows(recordings.rows());
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = k;
  const Groups groups(program, recordings);
  const Plan plan = plan_for(program, groups, options);
  std::vector<Solution> best(rows.size());
  std::mt19937_64 random(1);
  if (attempts == 0) attempts = reach != Reach::nearest ? 40 : 8;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    if (attempt > 0)
      for (std::size_t j = 0; j < index.size(); ++j)
        program.unknowns[j].start.value =
            std::uniform_real_distribution<double>(scatter[j].first, scatter[j].second)(random);
    Problem problem(program, plan, recordings, rows, groups, options);
    if (attempt == 0 && near) problem.set_latents(picked(*near, index));
    const Problem::Residuals r = problem.residuals({});
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      Solution now{{}, r.whitened.row(row).norm(), true};
      now.rows = static_cast<int>((r.raw.row(row).array() == r.raw.row(row).array()).count());
      for (std::size_t j = 0; j < index.size(); ++j) {
        double v = r.latent(row, static_cast<Eigen::Index>(j));
        if (index[j] < readings.size()) {
          const Reading& reading = readings[index[j]];
          v = within_half_a_turn(program, reading, v);
          if (reading.range)
            now.inside &= v >= reading.range->first - 1e-9 && v <= reading.range->second + 1e-9;
        }
        now.values.push_back(v);
      }
      if (better(now, best[k])) best[k] = std::move(now);
    }
    if (std::all_of(best.begin(), best.end(),
                    [](const Solution& s) { return s.left < kReached && s.inside; }))
      break;
  }
  double squares = 0, count = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const bool complete = best[k].rows >= static_cast<int>(near ? 1 : index.size());
    const Place place{recordings.file, recordings.lines[k], 0};
    if (reach == Reach::exactly && !complete)
      throw InputError(place, "this pose lacks measured values");
    if (reach == Reach::exactly && best[k].left >= kReached)
      throw InputError(place, "this pose cannot be reached by the linkage");
    if (!complete || best[k].left >= kReached)
      result.how[k] = Recovered::How::not_at_all;
    else if (!best[k].inside)
      result.how[k] = Recovered::How::outside;
    for (std::size_t j = 0; j < index.size(); ++j)
      result.settings.poses[k][index[j]] =
          complete ? best[k].values[j] : std::numeric_limits<double>::quiet_NaN();
    if (complete) squares += best[k].left * best[k].left, count += best[k].rows;
  }
  result.misfit = count > 0 ? std::sqrt(squares / count) : 0;
  return result;
}

std::size_t Recovered::count(How which) const {
  return static_cast<std::size_t>(std::count(how.begin(), how.end(), which));
}

Settings settings_from(Program& program, const Recordings& recordings, int threads) {
  const bool sensed =
      std::all_of(program.readings.begin(), program.readings.end(),
                  [&](const Reading& r) { return r.covariate || recordings.find(r.column); });
  return recover(program, recordings, sensed ? Reach::nearest : Reach::exactly, threads).settings;
}

}  // namespace talus
