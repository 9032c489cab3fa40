#include "framework/diagnosis/pool.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "framework/calibration/closing.h"
#include "framework/calibration/simulate.h"

namespace talus {
namespace {

constexpr double kLeastArc = 120 * deg;
constexpr double kBearable = 3;  // times the loads that were recorded
constexpr double kStep = 10;     // s, from pose to pose: the linkage is at rest in each

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

class Maker {
 public:
  Maker(const Ground& ground, const Recordings& recordings, const Trial& null,
        const std::vector<double>& fit_x, std::uint64_t seed)
      : ground_(ground),
        recordings_(recordings),
        null_(null),
        x_(fit_x),
        program_(compile(*ground.model, *ground.registry)),
        random_(seed) {
    for (std::size_t i = 0; i < program_.parameters.size(); ++i)
      program_.parameters[i].nominal.value = x_[i];
    for (const Unknown& u : program_.unknowns) groups_.insert(u.per.begin(), u.per.end());
  }

  Pool run(int count, const SuspectOptions& suspects) {
    ranges();
    Settings drawn = closed(draw(count));
    const Recordings simulated = simulate(program_, drawn, {1, 0, ground_.threads});
    pool_.recordings = recordings_;
    std::vector<std::size_t> rows = ground_.rows;
    Settings kept;
    for (std::size_t k = 0; k < drawn.poses.size(); ++k)
      if (append(simulated, k)) {
        rows.push_back(pool_.recordings.rows() - 1);
        kept.poses.push_back(drawn.poses[k]);
      }
    linear(rows, kept, suspects);
    return std::move(pool_);
  }

 private:
  void ranges() {
    pool_.coordinates = coordinates(program_);
    const Groups groups(program_, recordings_);
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
        for (std::size_t l = 0; l < groups.latent.size(); ++l)
          if (static_cast<std::size_t>(groups.latent[l]) == u)
            for (Eigen::Index k = 0; k < null_.latents.rows(); ++k)
              visited.push_back(null_.latents(k, static_cast<Eigen::Index>(l)));
        std::size_t at = program_.parameters.size();
        for (const auto& s : groups.shared) {
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

  Settings draw(int count) {
    Settings settings;
    for (int k = 0; k < count; ++k) {
      auto& pose = settings.poses.emplace_back();
      for (const Coordinate& c : pool_.coordinates) {
        if (!c.range) {
          pose.push_back(c.rest);
          continue;
        }
        std::uniform_real_distribution<double> within(c.range->first,
                                                      std::nextafter(c.range->second, 1e300));
        pose.push_back(rounded(within(random_), c.dimension, *c.range));
      }
    }
    return settings;
  }

  // Without those in which a loop cannot be closed.
  Settings closed(Settings drawn) {
    if (!has_loops(program_)) return drawn;
    ClosingOptions options;
    options.threads = ground_.threads;
    const Closed all = close_loops(program_, std::move(drawn), options);
    Settings kept;
    for (std::size_t k = 0; k < all.reached.size(); ++k)
      if (all.reached[k]) kept.poses.push_back(all.settings.poses[k]);
    return kept;
  }

  // Row k of the simulated ones, with its circumstances; false where a value is missing.
  bool append(const Recordings& simulated, std::size_t k) {
    for (const RecordedColumn& c : simulated.columns)
      if (!std::isfinite(c.values[k])) return false;
    Recordings& all = pool_.recordings;
    for (RecordedColumn& c : all.columns) {
      const bool own = c.name != "pose" && !groups_.contains(c.name);
      const RecordedColumn* given = own ? simulated.find(c.name) : nullptr;
      c.values.push_back(given ? given->values[k] : circumstance(c));
    }
    all.lines.push_back(0);
    if (all.use) all.use->push_back(true);
    if (!all.noise.covariance.empty()) {
      const std::vector<double> last = all.noise.covariance.back();
      all.noise.covariance.push_back(last);
    }
    return true;
  }

  double circumstance(const RecordedColumn& c) {
    if (groups_.contains(c.name)) return c.values[ground_.rows.back()];
    std::vector<double> seen;
    for (const double v : c.values)
      if (!std::isnan(v)) seen.push_back(v);
    if (seen.empty()) return std::nan("");
    if (c.name == "pose") return *std::max_element(seen.begin(), seen.end()) + 1;
    if (c.name == "time") return *std::max_element(seen.begin(), seen.end()) + kStep;
    if (c.name.starts_with("rate:")) return 0;
    if (c.name.starts_with("approach_")) return random_() % 2 ? 1 : -1;
    for (const Payload& p : program_.payloads)
      if (p.column == c.name) {
        const std::set<double> distinct(seen.begin(), seen.end());
        return *std::next(distinct.begin(), static_cast<long>(random_() % distinct.size()));
      }
    return seen.back();
  }

  // Without those that would load the linkage far more than it was: near a singular posture loads
  // grow without bound, and nobody would go there.
  std::vector<std::size_t> bearable(const std::vector<std::size_t>& rows) const {
    std::vector<std::size_t> kept;
    std::vector<std::pair<const RecordedColumn*, double>> loads;
    for (const RecordedColumn& c : pool_.recordings.columns) {
      if (!c.name.starts_with("load:")) continue;
      double most = 0;
      for (std::size_t r = 0; r < recordings_.rows(); ++r)
        if (std::isfinite(c.values[r])) most = std::max(most, std::abs(c.values[r]));
      if (most > 0) loads.emplace_back(&c, kBearable * most);
    }
    for (const std::size_t row : rows)
      if (row < recordings_.rows() || std::all_of(loads.begin(), loads.end(), [&](const auto& l) {
            return std::abs(l.first->values[row]) <= l.second;
          }))
        kept.push_back(row);
    return kept;
  }

  // Which of the settings a row of the pool is.
  std::size_t nth(std::size_t row, const std::vector<std::size_t>& rows) const {
    return static_cast<std::size_t>(std::find(rows.begin(), rows.end(), row) - rows.begin()) -
           ground_.rows.size();
  }

  void linear(const std::vector<std::size_t>& rows, const Settings& settings,
              const SuspectOptions& suspects) {
    pool_.recordings =
        with_circumstances(*ground_.model, *ground_.registry, program_, pool_.recordings, x_);
    const std::vector<std::size_t> sane = bearable(rows);
    const Ground both{ground_.model, ground_.registry, &pool_.recordings, sane, ground_.threads};
    Trial trial = null_;
    const Groups groups(program_, recordings_);
    if (!groups.latent.empty()) {
      const Eigen::Index old = null_.latents.rows();
      trial.latents.conservativeResize(
          old + static_cast<Eigen::Index>(sane.size() - ground_.rows.size()), Eigen::NoChange);
      for (std::size_t k = ground_.rows.size(); k < sane.size(); ++k) {
        const auto& setting = settings.poses[nth(sane[k], rows)];
        for (std::size_t l = 0; l < groups.latent.size(); ++l)
          trial.latents(old + static_cast<Eigen::Index>(k - ground_.rows.size()),
                        static_cast<Eigen::Index>(l)) =
              setting[program_.readings.size() + static_cast<std::size_t>(groups.latent[l])];
      }
    }
    StageOptions options;
    options.suspects = suspects;
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
      pool_.settings.poses.push_back(settings.poses[nth(at.rows[k], rows)]);
    }
    const Eigen::MatrixXd old_columns = all(old_rows, Eigen::all);
    pool_.suspects = std::move(at.suspects);
    pool_.suspects.candidates.columns = old_columns;
  }

  const Ground& ground_;
  const Recordings& recordings_;
  const Trial& null_;
  const std::vector<double>& x_;
  Program program_;
  std::mt19937_64 random_;
  std::set<std::string> groups_;  // columns that say which unknowns poses share: as the last
  Pool pool_;
};

}  // namespace

Pool pool_of(const Ground& ground, const Recordings& recordings, const Trial& null,
             const std::vector<double>& fit_x, int count, std::uint64_t seed,
             const SuspectOptions& suspects) {
  return Maker(ground, recordings, null, fit_x, seed).run(count, suspects);
}

}  // namespace talus
