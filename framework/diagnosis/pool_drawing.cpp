#include "framework/diagnosis/pool_drawing.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "framework/calibration/closing.h"
#include "framework/calibration/load_columns.h"
#include "framework/calibration/simulate.h"
#include "framework/dsl/grammar.h"

namespace talus {
namespace {

constexpr double kLeastArc = 120 * deg;
constexpr double kBearable = 3;     // times the loads that were recorded
constexpr std::size_t kAgain = 60;  // recorded poses to repeat
constexpr double kStep = 10;        // s, from pose to pose: the linkage is at rest in each

std::pair<double, double> widened(double low, double high, Dimension dimension, double least) {
  double half = high - low;
  if (dimension == angle) half = std::min(std::max(half, least / 2), 180 * deg);
  const double middle = (low + high) / 2;
  return {middle - half, middle + half};
}

// Settings are given to a tenth of a degree and a hundredth of a millimetre.
double rounded(double value, Dimension dimension, std::pair<double, double> range) {
  const double step = dimension == angle ? 0.1 * deg : dimension == length ? 0.01 : 1e-6;
  double r = step * std::round(value / step);
  if (r < range.first) r += step;
  if (r > range.second) r -= step;
  return r < range.first ? value : r;
}

class Drawer {
 public:
  Drawer(const Ground& ground, Program& program, const Recordings& recordings, const Trial& null,
         const std::vector<double>& x, const PoolOptions& options)
      : ground_(ground),
        program_(program),
        recordings_(recordings),
        null_(null),
        x_(x),
        options_(options),
        groups_(program, recordings),
        random_(options.seed) {}

  Drawing run() {
    out_.recordings = recordings_;
    ranges();
    payloads();
    if (options_.turned) turned();
    free();
    again();
    Settings settings;
    for (const Drawn& d : wanted_) settings.poses.push_back(d.setting);
    const Recordings simulated = simulate(program_, settings, {1, 0, ground_.threads});
    for (std::size_t k = 0; k < wanted_.size(); ++k)
      if (append(simulated, k)) out_.drawn.push_back(wanted_[k]);
    return std::move(out_);
  }

 private:
  void ranges() {
    out_.coordinates = coordinates(program_);
    const std::size_t readings = program_.readings.size();
    for (std::size_t i = 0; i < out_.coordinates.size(); ++i) {
      Coordinate& c = out_.coordinates[i];
      bool stated = false, moves = true;
      std::vector<double> visited;
      if (i < readings) {
        const Reading& r = program_.readings[i];
        stated = r.range.has_value();
        moves = !r.covariate;
        if (const RecordedColumn* column = recordings_.find(r.column))
          for (const std::size_t row : ground_.rows)
            if (!std::isnan(column->values[row])) visited.push_back(column->values[row]);
        if (!moves && !visited.empty()) c.rest = visited.back();
      } else {
        const std::size_t u = i - readings;
        const Unknown& unknown = program_.unknowns[u];
        moves = unknown.per.empty();
        stated = moves && unknown.start.bounds && std::isfinite(unknown.start.bounds->first) &&
                 std::isfinite(unknown.start.bounds->second);
        for (std::size_t l = 0; l < groups_.latent.size(); ++l)
          if (static_cast<std::size_t>(groups_.latent[l]) == u)
            for (Eigen::Index k = 0; k < null_.latents.rows(); ++k)
              visited.push_back(null_.latents(k, static_cast<Eigen::Index>(l)));
        std::size_t at = program_.parameters.size();
        for (const auto& s : groups_.shared) {
          if (static_cast<std::size_t>(s.unknown) == u)
            c.rest = x_[at + static_cast<std::size_t>(s.instance[ground_.rows.back()])];
          at += static_cast<std::size_t>(s.instances);
        }
      }
      if (!moves) {
        c.range.reset();
      } else if (!stated && !visited.empty()) {
        const auto [low, high] = std::minmax_element(visited.begin(), visited.end());
        c.range = widened(*low, *high, c.dimension, i < readings ? kLeastArc : 0);
        if (i < readings && c.dimension == number) levels_[i] = visited;
      }
      out_.assumed.push_back(moves && !stated && !levels_.contains(i));
    }
  }

  // What may be hung at each payload's place; a column that is not recorded is none so far.
  void payloads() {
    for (const Element& e : ground_.model->root.children) {
      const Attribute *column = e.find("column"), *range = e.find("range");
      if (e.tag != "payload" || !column || masses_.contains(column->text)) continue;
      if (!recordings_.find(column->text)) {
        if (!range) continue;
        out_.recordings.columns.push_back(
            {column->text, *parse_unit("kg"), std::vector<double>(recordings_.rows()), {}});
      }
      std::vector<double> ends{0, 0};
      for (const double v : out_.recordings.find(column->text)->values)
        if (!std::isnan(v)) ends[1] = std::max(ends[1], v);
      if (range) {
        ends.clear();
        for (const std::string& end : split_list(range->text))
          ends.push_back(parse_quantity(end, mass, program_.units, range->place).value);
      }
      masses_[column->text] = {ends.at(0), ends.at(1)};
    }
  }

  void turned() {
    out_.mountings = mountings(program_);
    if (!out_.mountings.empty() && !recordings_.find(gravity_columns[0]))
      for (const char* name : gravity_columns)
        out_.recordings.columns.push_back(
            {name, Unit{"", number}, std::vector<double>(recordings_.rows(), std::nan("")), {}});
  }

  // Adds a pose as the linkage stands, and where turned ones are asked for another one.
  void add(Drawn d, bool turn) {
    if (turn) d.origin.mounting = static_cast<int>(random_() % out_.mountings.size());
    wanted_.push_back(std::move(d));
  }

  double anywhere(std::size_t i) {
    const Coordinate& c = out_.coordinates[i];
    if (!c.range) return c.rest;
    if (const auto it = levels_.find(i); it != levels_.end())
      return it->second[random_() % it->second.size()];
    std::uniform_real_distribution<double> within(c.range->first,
                                                  std::nextafter(c.range->second, 1e300));
    return rounded(within(random_), c.dimension, *c.range);
  }

  void free() {
    for (const Feature& f : program_.features)
      if (f.kind == Kind::nothing) out_.loops.push_back(f.name);
    for (const bool turn : {false, true}) {
      const std::size_t first = wanted_.size();
      for (int k = 0; k < options_.count && !(turn && out_.mountings.empty()); ++k) {
        Drawn d;
        for (std::size_t i = 0; i < out_.coordinates.size(); ++i) d.setting.push_back(anywhere(i));
        add(std::move(d), turn);
      }
      if (has_loops(program_)) close(first);
    }
  }

  // Of the poses wanted from `first` on, those that can be moved until all loops are closed.
  void close(std::size_t first) {
    for (std::size_t i = 0; i < program_.readings.size(); ++i)
      program_.readings[i].range = out_.coordinates[i].range;
    Settings drawn;
    for (std::size_t k = first; k < wanted_.size(); ++k) drawn.poses.push_back(wanted_[k].setting);
    if (drawn.poses.empty()) return;
    Closed closed = close_loops(program_, std::move(drawn), {.threads = ground_.threads});
    std::size_t next = first;
    for (std::size_t k = 0; k < closed.reached.size(); ++k)
      if (closed.reached[k])
        wanted_[next++] = {std::move(closed.settings.poses[k]), wanted_[first + k].origin};
    wanted_.resize(next);
  }

  // Where a recorded pose was; false where a value is missing.
  bool recorded_setting(std::size_t k, std::vector<double>& setting) const {
    const std::size_t row = ground_.rows[k];
    for (const Coordinate& c : out_.coordinates) setting.push_back(c.rest);
    for (std::size_t i = 0; i < program_.readings.size(); ++i)
      if (const RecordedColumn* column = recordings_.find(program_.readings[i].column))
        setting[i] = column->values[row];
    const std::size_t readings = program_.readings.size();
    for (std::size_t l = 0; l < groups_.latent.size(); ++l)
      setting[readings + static_cast<std::size_t>(groups_.latent[l])] =
          null_.latents(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l));
    std::size_t at = program_.parameters.size();
    for (const auto& s : groups_.shared) {
      setting[readings + static_cast<std::size_t>(s.unknown)] =
          x_[at + static_cast<std::size_t>(s.instance[row])];
      at += static_cast<std::size_t>(s.instances);
    }
    for (std::size_t i = 0; i < setting.size(); ++i)
      if (!out_.coordinates[i].covariate && !std::isfinite(setting[i])) return false;
    return true;
  }

  // Some of the recorded poses under other circumstances, evenly over the recordings.
  void again() {
    const bool approached =
        std::any_of(recordings_.columns.begin(), recordings_.columns.end(),
                    [](const RecordedColumn& c) { return c.name.starts_with("approach_"); });
    if (!approached && masses_.empty() && out_.mountings.empty()) return;
    const std::size_t n = ground_.rows.size(), count = std::min(n, kAgain);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t k = i * n / count;
      Drawn d;
      if (!recorded_setting(k, d.setting)) continue;
      d.origin.again = static_cast<int>(ground_.rows[k]);
      d.origin.other_side = approached;
      add(d, false);
      if (!out_.mountings.empty()) add(d, true);
    }
  }

  // Row k of the simulated ones, with its circumstances; false where a value is missing.
  bool append(const Recordings& simulated, std::size_t k) {
    for (const RecordedColumn& c : simulated.columns)
      if (!std::isfinite(c.values[k])) return false;
    Recordings& all = out_.recordings;
    for (RecordedColumn& c : all.columns) {
      const RecordedColumn* given =
          c.name == "pose" || is_group(c.name) ? nullptr : simulated.find(c.name);
      c.values.push_back(given ? given->values[k] : circumstance(c, wanted_[k].origin));
    }
    all.lines.push_back(0);
    if (all.use) all.use->push_back(true);
    if (!all.noise.covariance.empty()) {
      const std::vector<double> last = all.noise.covariance.back();
      all.noise.covariance.push_back(last);
    }
    return true;
  }

  // Does the column say which rows share an unknown?
  bool is_group(const std::string& column) const {
    return std::any_of(program_.unknowns.begin(), program_.unknowns.end(), [&](const Unknown& u) {
      return std::find(u.per.begin(), u.per.end(), column) != u.per.end();
    });
  }

  double circumstance(const RecordedColumn& c, const Origin& origin) {
    if (origin.mounting >= 0)
      for (int i = 0; i < 3; ++i)
        if (c.name == gravity_columns[static_cast<std::size_t>(i)])
          return out_.mountings[static_cast<std::size_t>(origin.mounting)].down[i];
    if (const auto it = masses_.find(c.name); it != masses_.end())
      return random_() % 2 ? it->second.second : it->second.first;
    const double then =
        origin.again >= 0 ? c.values[static_cast<std::size_t>(origin.again)] : std::nan("");
    if (c.name.starts_with("approach_")) {
      const double other = random_() % 2 ? 1 : -1;
      return then != 0 && !std::isnan(then) ? -then : other;
    }
    // What holds as long as the linkage stays mounted where it is.
    const bool mounted = std::find(gravity_columns.begin(), gravity_columns.end(), c.name) !=
                             gravity_columns.end() ||
                         is_group(c.name);
    if (mounted) return origin.again >= 0 ? then : c.values[ground_.rows.back()];
    if (c.name.starts_with("rate:")) return 0;
    const bool goes_on = c.name == "pose" || c.name == "time";
    double last = std::nan("");
    for (std::size_t r = 0; r < (goes_on ? c.values.size() : recordings_.rows()); ++r)
      if (const double v = c.values[r]; !std::isnan(v)) last = goes_on && last > v ? last : v;
    return c.name == "pose" ? last + 1 : c.name == "time" ? last + kStep : last;
  }

  const Ground& ground_;
  Program& program_;
  const Recordings& recordings_;
  const Trial& null_;
  const std::vector<double>& x_;
  const PoolOptions& options_;
  Groups groups_;
  std::mt19937_64 random_;
  std::map<std::string, std::pair<double, double>> masses_;  // of payloads' columns
  std::map<std::size_t, std::vector<double>>
      levels_;  // a plain number (a hole, a step): as visited
  std::vector<Drawn> wanted_;
  Drawing out_;
};

}  // namespace

Drawing drawn_poses(const Ground& ground, Program& program, const Recordings& recordings,
                    const Trial& null, const std::vector<double>& x, const PoolOptions& options) {
  return Drawer(ground, program, recordings, null, x, options).run();
}

}  // namespace talus
