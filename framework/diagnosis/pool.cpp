#include "framework/diagnosis/pool.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "framework/calibration/load_columns.h"
#include "framework/calibration/simulate.h"
#include "framework/diagnosis/closed_loops.h"
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

struct Drawn {
  std::vector<double> setting;
  Origin origin;
};

class Maker {
 public:
  Maker(const Ground& ground, const Recordings& recordings, const Trial& null,
        const std::vector<double>& fit_x, const PoolOptions& options)
      : ground_(ground),
        recordings_(recordings),
        null_(null),
        x_(fit_x),
        options_(options),
        program_(compile(*ground.model, *ground.registry)),
        groups_(program_, recordings),
        random_(options.seed) {
    for (std::size_t i = 0; i < program_.parameters.size(); ++i)
      program_.parameters[i].nominal.value = x_[i];
  }

  Pool run() {
    pool_.recordings = recordings_;
    ranges();
    payloads();
    if (options_.turned) turned();
    free();
    again();
    Settings settings;
    for (const Drawn& d : drawn_) settings.poses.push_back(d.setting);
    const Recordings simulated = simulate(program_, settings, {1, 0, ground_.threads});
    std::vector<std::size_t> rows = ground_.rows;
    std::vector<Drawn> kept;
    for (std::size_t k = 0; k < drawn_.size(); ++k)
      if (append(simulated, k)) {
        rows.push_back(pool_.recordings.rows() - 1);
        kept.push_back(drawn_[k]);
      }
    drawn_ = std::move(kept);
    linear(rows);
    return std::move(pool_);
  }

 private:
  void ranges() {
    pool_.coordinates = coordinates(program_);
    const std::size_t readings = program_.readings.size();
    for (std::size_t i = 0; i < pool_.coordinates.size(); ++i) {
      Coordinate& c = pool_.coordinates[i];
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
      }
      pool_.assumed.push_back(moves && !stated);
    }
  }

  // What may be hung at each payload's place; a column that is not recorded is none so far.
  void payloads() {
    for (const Element& e : ground_.model->root.children) {
      const Attribute *column = e.find("column"), *range = e.find("range");
      if (e.tag != "payload" || !column || masses_.contains(column->text)) continue;
      if (!recordings_.find(column->text)) {
        if (!range) continue;
        pool_.recordings.columns.push_back(
            {column->text, *parse_unit("kg"), std::vector<double>(recordings_.rows()), {}});
      }
      std::vector<double> ends{0, 0};
      for (const double v : pool_.recordings.find(column->text)->values)
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
    pool_.mountings = mountings(program_);
    if (!pool_.mountings.empty() && !recordings_.find(gravity_columns[0]))
      for (const char* name : gravity_columns)
        pool_.recordings.columns.push_back(
            {name, Unit{"", number}, std::vector<double>(recordings_.rows(), std::nan("")), {}});
  }

  // Adds a pose as the linkage stands, and where turned ones are asked for another one.
  void add(Drawn d, bool turn) {
    if (turn) d.origin.mounting = static_cast<int>(random_() % pool_.mountings.size());
    drawn_.push_back(std::move(d));
  }

  void free() {
    ClosedLoops loops(program_);
    pool_.loops = loops.names();
    for (const bool turn : {false, true})
      for (int k = 0; k < options_.count && !(turn && pool_.mountings.empty()); ++k) {
        Drawn d;
        for (const Coordinate& c : pool_.coordinates) {
          if (!c.range) {
            d.setting.push_back(c.rest);
            continue;
          }
          std::uniform_real_distribution<double> within(c.range->first,
                                                        std::nextafter(c.range->second, 1e300));
          d.setting.push_back(rounded(within(random_), c.dimension, *c.range));
        }
        const std::span<const double> parameters(x_.data(), program_.parameters.size());
        if (loops.none() || loops.close(d.setting, pool_.coordinates, parameters))
          add(std::move(d), turn);
      }
  }

  // Where a recorded pose was; false where a value is missing.
  bool recorded_setting(std::size_t k, std::vector<double>& setting) const {
    const std::size_t row = ground_.rows[k];
    for (const Coordinate& c : pool_.coordinates) setting.push_back(c.rest);
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
      if (!pool_.coordinates[i].covariate && !std::isfinite(setting[i])) return false;
    return true;
  }

  // Some of the recorded poses under other circumstances, evenly over the recordings.
  void again() {
    const bool approached =
        std::any_of(recordings_.columns.begin(), recordings_.columns.end(),
                    [](const RecordedColumn& c) { return c.name.starts_with("approach_"); });
    if (!approached && masses_.empty() && pool_.mountings.empty()) return;
    const std::size_t n = ground_.rows.size(), count = std::min(n, kAgain);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t k = i * n / count;
      Drawn d;
      if (!recorded_setting(k, d.setting)) continue;
      d.origin.again = static_cast<int>(ground_.rows[k]);
      d.origin.other_side = approached;
      add(d, false);
      if (!pool_.mountings.empty()) add(d, true);
    }
  }

  // Row k of the simulated ones, with its circumstances; false where a value is missing.
  bool append(const Recordings& simulated, std::size_t k) {
    for (const RecordedColumn& c : simulated.columns)
      if (!std::isfinite(c.values[k])) return false;
    Recordings& all = pool_.recordings;
    for (RecordedColumn& c : all.columns) {
      const RecordedColumn* given = c.name == "pose" ? nullptr : simulated.find(c.name);
      c.values.push_back(given ? given->values[k] : circumstance(c, drawn_[k].origin));
    }
    all.lines.push_back(0);
    if (all.use) all.use->push_back(true);
    if (!all.noise.covariance.empty()) {
      const std::vector<double> last = all.noise.covariance.back();
      all.noise.covariance.push_back(last);
    }
    return true;
  }

  double circumstance(const RecordedColumn& c, const Origin& origin) {
    if (origin.mounting >= 0)
      for (int i = 0; i < 3; ++i)
        if (c.name == gravity_columns[static_cast<std::size_t>(i)])
          return pool_.mountings[static_cast<std::size_t>(origin.mounting)].down[i];
    if (const auto it = masses_.find(c.name); it != masses_.end())
      return random_() % 2 ? it->second.second : it->second.first;
    const double then =
        origin.again >= 0 ? c.values[static_cast<std::size_t>(origin.again)] : std::nan("");
    if (c.name.starts_with("approach_")) {
      const double other = random_() % 2 ? 1 : -1;
      return then != 0 && !std::isnan(then) ? -then : other;
    }
    // What holds as long as the linkage stays mounted where it is.
    const bool mounted =
        std::find(gravity_columns.begin(), gravity_columns.end(), c.name) !=
            gravity_columns.end() ||
        std::any_of(program_.unknowns.begin(), program_.unknowns.end(), [&](const Unknown& u) {
          return std::find(u.per.begin(), u.per.end(), c.name) != u.per.end();
        });
    if (mounted) return origin.again >= 0 ? then : c.values[ground_.rows.back()];
    if (c.name.starts_with("rate:")) return 0;
    const bool goes_on = c.name == "pose" || c.name == "time";
    double last = std::nan("");
    for (std::size_t r = 0; r < (goes_on ? c.values.size() : recordings_.rows()); ++r)
      if (const double v = c.values[r]; !std::isnan(v)) last = goes_on && last > v ? last : v;
    return c.name == "pose" ? last + 1 : c.name == "time" ? last + kStep : last;
  }

  // Of a row behind the recorded ones.
  const Drawn& drawn(std::size_t row) const { return drawn_[row - recordings_.rows()]; }

  // Without those that would load the linkage far more than it was, or would be with the other
  // payloads and mountings: near a singular posture loads grow without bound, and nobody would go
  // there.
  std::vector<std::size_t> bearable(const std::vector<std::size_t>& rows) const {
    std::vector<std::size_t> kept;
    std::vector<std::pair<const RecordedColumn*, double>> loads;
    for (const RecordedColumn& c : pool_.recordings.columns) {
      if (!c.name.starts_with("load:")) continue;
      double most = 0;
      for (std::size_t r = 0; r < pool_.recordings.rows(); ++r)
        if (std::isfinite(c.values[r]) && (r < recordings_.rows() || drawn(r).origin.again >= 0))
          most = std::max(most, std::abs(c.values[r]));
      if (most > 0) loads.emplace_back(&c, kBearable * most);
    }
    for (const std::size_t row : rows)
      if (row < recordings_.rows() || std::all_of(loads.begin(), loads.end(), [&](const auto& l) {
            return std::abs(l.first->values[row]) <= l.second;
          }))
        kept.push_back(row);
    return kept;
  }

  void linear(const std::vector<std::size_t>& rows) {
    pool_.recordings =
        with_circumstances(*ground_.model, *ground_.registry, program_, pool_.recordings, x_);
    const std::vector<std::size_t> sane = bearable(rows);
    const Ground both{ground_.model, ground_.registry, &pool_.recordings, sane, ground_.threads};
    Trial trial = null_;
    if (!groups_.latent.empty()) {
      const Eigen::Index old = null_.latents.rows();
      trial.latents.conservativeResize(
          old + static_cast<Eigen::Index>(sane.size() - ground_.rows.size()), Eigen::NoChange);
      for (std::size_t k = ground_.rows.size(); k < sane.size(); ++k) {
        const auto& setting = drawn(sane[k]).setting;
        for (std::size_t l = 0; l < groups_.latent.size(); ++l)
          trial.latents(old + static_cast<Eigen::Index>(k - ground_.rows.size()),
                        static_cast<Eigen::Index>(l)) =
              setting[program_.readings.size() + static_cast<std::size_t>(groups_.latent[l])];
      }
    }
    StageOptions options;
    options.suspects = options_.suspects;
    Linearised at = linearised(both, trial, options);

    const std::size_t recorded = recordings_.rows();
    std::vector<int> old_rows, with_priors;
    std::vector<std::vector<int>> of_pose(at.rows.size());
    for (std::size_t r = 0; r < at.baseline.pose.size(); ++r) {
      const int pose = at.baseline.pose[r], row = static_cast<int>(r);
      if (pose < 0) {
        with_priors.push_back(row);
      } else if (at.rows[static_cast<std::size_t>(pose)] < recorded) {
        old_rows.push_back(row), with_priors.push_back(row);
      } else {
        of_pose[static_cast<std::size_t>(pose)].push_back(row);
      }
    }
    pool_.recorded = at.rows;
    Baseline& b = pool_.baseline;
    b.noise_known = at.baseline.noise_known;
    b.rows = at.baseline.rows(with_priors);
    b.columns = at.baseline.columns(with_priors, Eigen::all);
    for (const int r : with_priors) b.pose.push_back(at.baseline.pose[static_cast<std::size_t>(r)]);
    const double share =
        static_cast<double>(old_rows.size()) / static_cast<double>(at.columns.rows());
    b.taken = at.baseline.taken * share;
    const Eigen::MatrixXd& all = at.suspects.candidates.columns;
    for (std::size_t k = 0; k < of_pose.size(); ++k) {
      if (of_pose[k].empty()) continue;
      pool_.poses.push_back(
          {at.baseline.columns(of_pose[k], Eigen::all), all(of_pose[k], Eigen::all)});
      pool_.rows.push_back(at.rows[k]);
      pool_.settings.poses.push_back(drawn(at.rows[k]).setting);
      pool_.origins.push_back(drawn(at.rows[k]).origin);
    }
    const Eigen::MatrixXd old_columns = all(old_rows, Eigen::all);
    pool_.suspects = std::move(at.suspects);
    pool_.suspects.candidates.columns = old_columns;
  }

  const Ground& ground_;
  const Recordings& recordings_;
  const Trial& null_;
  const std::vector<double>& x_;
  const PoolOptions& options_;
  Program program_;
  Groups groups_;
  std::mt19937_64 random_;
  std::map<std::string, std::pair<double, double>> masses_;  // of payloads' columns
  std::vector<Drawn> drawn_;  // in the order of the rows behind the recorded ones
  Pool pool_;
};

}  // namespace

Pool pool_of(const Ground& ground, const Recordings& recordings, const Trial& null,
             const std::vector<double>& fit_x, const PoolOptions& options) {
  return Maker(ground, recordings, null, fit_x, options).run();
}

}  // namespace talus
