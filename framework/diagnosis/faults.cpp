#include "framework/diagnosis/faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "framework/diagnosis/corrections.h"
#include "framework/diagnosis/fault_trials.h"

namespace talus {
namespace {

// Nothing is looked for below: a wrong column is off by parts of its range, which is tens of sigmas
// at least; physics that leaves three sigmas in every row is already large.
constexpr double worth_looking = 10;
// Less than this is less than the noise: values that were made smaller than they are.
constexpr double less_than_noise = 0.6, surely = 1e-6;
constexpr double unlikely = 1e-3;  // a chi-square that says that something is left
// Tolerances by which a parameter, or all together, are off nominal where no tolerance is so wrong.
constexpr double far = 20;
// Without stated noise: a misfit of this share of the measured range.
constexpr double worth_looking_percent = 1;
// A correction has no free number; what it gains by chance among some hundred tries is a per cent
// or two. What physics could make it gain is more, but not a factor of five.
constexpr double falls_to = 0.2;
constexpr double nearer_to_noise = 0.5;
constexpr double falls_without_noise = 0.01;  // where there is no noise to be near to
// What is left over the measured range, root mean square: numbers that explain nothing leave 0.3.
constexpr double explained = 0.05;
// Recordings fitted as well as before: a factor on chi-square.
constexpr double as_well = 1.5;
// Others within this factor of the best explain the recordings as well.
constexpr double as_good = 1.5;
constexpr int most_faults = 3;
constexpr std::size_t finalists = 6, row_finalists = 3, partners = 4;
constexpr int shifts = 3, pieces = 8;

struct Candidate {
  std::vector<Correction> corrections;
  Recordings recordings;
  FaultTrial trial;
};

// Nearer to what noise leaves.
double badness(const FaultTrial& trial) { return std::abs(std::log(std::max(trial.left, 1e-300))); }
bool better(const Candidate& a, const Candidate& b) { return badness(a.trial) < badness(b.trial); }

// Measurements made smaller by a factor f leave residuals that are smaller by f even if nothing was
// wrong, should the geometry be free to follow. That is no merit, unless the geometry had to go far
// from nominal before and needs not now.
double shrinks(const std::vector<Correction>& corrections) {
  double factor = 1;
  for (const Correction& c : corrections)
    if (c.kind == "wrong-unit" && c.of_measurements && !c.columns.empty())
      factor = std::min(factor, c.columns[0].factor);
  return factor;
}

class Search {
 public:
  Search(const Program& program, FaultTrials& trials, bool noise_known)
      : program_(program), trials_(trials), noise_known_(noise_known) {}

  // The best correction of one fault, then of two; none where nothing mends the misfit.
  std::vector<Candidate> mend(const Recordings& recordings, const FaultTrial& before);

 private:
  bool decides(const Candidate& after, const FaultTrial& before) const;
  std::vector<Candidate> one_more(const Candidate& to);
  std::vector<Candidate> finish(std::vector<Candidate> all, const FaultTrial& before);
  void place_shift(Candidate& candidate, const Recordings& before);

  const Program& program_;
  FaultTrials& trials_;
  const bool noise_known_;
};

bool Search::decides(const Candidate& candidate, const FaultTrial& before) const {
  const FaultTrial& after = candidate.trial;
  if (!std::isfinite(after.left) || after.share > explained) return false;
  const bool geometry_returns = before.prior > far * far && after.prior < falls_to * before.prior;
  const double shrunk = geometry_returns ? 1 : std::pow(shrinks(candidate.corrections), 2);
  if (!noise_known_) return after.rows < falls_without_noise * shrunk * before.rows;
  auto nearer = [](double is, double was) {
    return std::abs(std::log(is)) < nearer_to_noise * std::abs(std::log(was));
  };
  const double was = std::min(before.left, 1e12);
  if (was > worth_looking && after.left < falls_to * shrunk * was && nearer(after.left, was))
    return true;
  if (geometry_returns && after.rows < as_well * std::max(1.0, before.rows)) return true;
  return before.rows < less_than_noise && after.prior < falls_to * before.prior &&
         nearer(after.rows, before.rows);
}

// Quick trials of every further correction, best first.
std::vector<Candidate> Search::one_more(const Candidate& to) {
  std::vector<Correction> all = column_corrections(program_, to.recordings);
  const auto n = to.recordings.rows();
  const bool moved = std::any_of(to.corrections.begin(), to.corrections.end(),
                                 [](const Correction& c) { return c.shift != 0; });
  if (!program_.readings.empty() && !moved)
    for (int s = -shifts; s <= shifts; ++s)
      for (int piece = 0; s != 0 && piece < pieces; ++piece)
        all.push_back(row_correction(program_, to.recordings, s, n * piece / pieces));
  std::vector<Candidate> columns, rows;
  for (Correction& c : all) {
    Candidate candidate{to.corrections, corrected(to.recordings, c), {}};
    const bool by_rows = c.shift != 0;
    candidate.corrections.push_back(std::move(c));
    candidate.trial = trials_.quick(candidate.recordings);
    if (!(badness(candidate.trial) < badness(to.trial))) continue;
    std::vector<Candidate>& found = by_rows ? rows : columns;
    found.push_back(std::move(candidate));
    std::stable_sort(found.begin(), found.end(), better);
    if (found.size() > (by_rows ? row_finalists : finalists)) found.pop_back();
  }
  columns.insert(columns.end(), std::make_move_iterator(rows.begin()),
                 std::make_move_iterator(rows.end()));
  return columns;
}

// The row from which measurements are shifted: where the rows before fit better as recorded and
// those after fit better shifted.
void Search::place_shift(Candidate& candidate, const Recordings& before) {
  const Correction last = candidate.corrections.back();
  for (int round = 0; round < 4; ++round) {
    const Recordings whole = corrected(before, row_correction(program_, before, last.shift, 0));
    auto misfit = [&](const Recordings& r) {
      Problem p = trials_.problem(r);
      p.set_weights(candidate.trial.x);
      const Problem::Residuals residuals = p.residuals(candidate.trial.x);
      std::vector<double> squares(r.rows(), 0);
      for (std::size_t k = 0; k < residuals.poses.size(); ++k)
        squares[residuals.poses[k]] =
            residuals.whitened.row(static_cast<Eigen::Index>(k)).squaredNorm();
      return squares;
    };
    const std::vector<double> as_recorded = misfit(before), shifted = misfit(whole);
    // Rows whose measurement is lost by a shift backwards count neither way.
    const std::size_t n = before.rows(), lost = last.shift < 0 ? -last.shift : 0;
    double sum = std::accumulate(shifted.begin(), shifted.end(), 0.0);
    double least = std::numeric_limits<double>::infinity();
    std::size_t from = 0;
    for (std::size_t k = 0; k < n; ++k) {
      double all = sum;
      for (std::size_t j = k; j < std::min(n, k + lost); ++j)
        all += std::min(as_recorded[j], shifted[j]) - shifted[j];
      if (k == 0 || all < least - 1e-9 * least) least = all, from = k;
      sum += as_recorded[k] - shifted[k];
    }
    const Correction next = row_correction(program_, before, last.shift, from);
    if (from == candidate.corrections.back().from) return;
    Candidate moved{candidate.corrections, corrected(before, next), {}};
    moved.corrections.back() = next;
    moved.trial = trials_.full(moved.recordings);
    if (!(moved.trial.left < candidate.trial.left)) return;
    candidate = std::move(moved);
  }
}

// Full fits; those that decide, best first.
std::vector<Candidate> Search::finish(std::vector<Candidate> all, const FaultTrial& before) {
  std::vector<Candidate> result;
  for (Candidate& c : all) {
    c.trial = trials_.full(c.recordings);
    if (decides(c, before)) result.push_back(std::move(c));
  }
  // Other units only where nothing else explains it.
  std::stable_sort(result.begin(), result.end(), better);
  std::stable_partition(result.begin(), result.end(),
                        [](const Candidate& c) { return shrinks(c.corrections) == 1; });
  return result;
}

std::vector<Candidate> Search::mend(const Recordings& recordings, const FaultTrial& before) {
  Candidate none{{}, recordings, trials_.quick(recordings)};
  std::vector<Candidate> single = one_more(none);
  for (Candidate& c : single)
    if (c.corrections.back().shift != 0) {
      c.trial = trials_.full(c.recordings);
      if (std::isfinite(c.trial.left)) place_shift(c, recordings);
    }
  std::vector<Candidate> found = finish(single, before);
  if (!found.empty()) return found;
  std::vector<Candidate> pairs;
  std::stable_sort(single.begin(), single.end(), better);
  single.resize(std::min(single.size(), partners));
  for (Candidate& first : single) {
    for (Candidate& second : one_more(first)) {
      const Correction& last = second.corrections.back();
      if (last.shift != 0) {
        second.trial = trials_.full(second.recordings);
        if (std::isfinite(second.trial.left)) place_shift(second, first.recordings);
      }
      pairs.push_back(std::move(second));
    }
    std::stable_sort(pairs.begin(), pairs.end(), better);
    if (pairs.size() > finalists) pairs.resize(finalists);
  }
  return finish(std::move(pairs), before);
}

// What the correction gains, in words.
std::string gain(const FaultTrial& before, const FaultTrial& after) {
  if (!std::isfinite(before.left))
    return "As recorded, the model cannot be evaluated; corrected, it can";
  if (before.rows > as_well * after.rows)
    return fmt::format("Corrected, chi-square per degree of freedom falls from {:.3g} to {:.3g}",
                       before.rows, after.rows);
  return fmt::format(
      "Corrected, the parameters lie {:.3g} tolerances from their nominal values, together, "
      "instead "
      "of {:.3g}",
      std::sqrt(after.prior), std::sqrt(before.prior));
}

// Is the fit bad enough, or the geometry far enough off?
bool worth(const Fit* fit) {
  if (!fit) return true;
  double percent = 0, off = 0;
  for (const Measure& m : fit->measures_fit)
    if (std::isfinite(m.percent_fsr)) percent = std::max(percent, m.percent_fsr);
  if (!fit->noise_known) return percent > worth_looking_percent;
  for (const FittedValue& v : fit->parameters)
    if (v.tolerance) off = std::max(off, std::abs(v.value - v.nominal) / *v.tolerance);
  if (!(fit->dof > 0)) return off > far;
  const double left = fit->chi2 / fit->dof;
  return left > worth_looking || 2 * fit->cost / fit->dof > worth_looking || off > far ||
         (left < less_than_noise && fit->chi2_p > 1 - surely);
}

}  // namespace

Faults find_faults(const Program& program, const Recordings& recordings, const Split& split,
                   const Fit* fit, const FaultOptions& options) {
  Faults result;
  result.recordings = recordings;
  const bool looks = worth(fit);
  std::vector<Fault> rows = faults_of_rows(program, recordings, split.fit, result.left_out);
  // A reading may stand still for good reason; where the model fits, it does.
  if (!looks) std::erase_if(rows, [](const Fault& f) { return f.kind == "constant-column"; });
  result.found = std::move(rows);
  if (looks) {
    const bool noise_known = !fit || fit->noise_known;
    FaultTrials trials(program, recordings, split.fit, options);
    FaultTrial before = trials.full(recordings);
    // The calibration has had more starts.
    if (fit && 2 * fit->cost / std::max(1.0, fit->dof) < before.left && noise_known) {
      before.left = 2 * fit->cost / std::max(1.0, fit->dof);
      before.rows = fit->chi2 / std::max(1.0, fit->dof);
      before.prior = prior_squares(trials.problem(recordings), fit->x);
    }
    result.before = before.left;
    for (int n = 0; n < most_faults;) {
      Search search(program, trials, noise_known);
      const std::vector<Candidate> found = search.mend(result.recordings, before);
      if (found.empty()) break;
      const Candidate& best = found.front();
      std::string rivals;
      for (std::size_t i = 1; i < found.size(); ++i)
        if (found[i].trial.left < as_good * best.trial.left &&
            found[i].corrections.size() == best.corrections.size())
          rivals += fmt::format(" Or {}; that explains the recordings as well.",
                                found[i].corrections.back().statement);
      for (const Correction& c : best.corrections) {
        std::string statement = c.statement;
        statement[0] = static_cast<char>(std::toupper(statement[0]));
        result.found.push_back(
            {c.kind,
             c.where,
             fmt::format("{}. {}.{}", statement, gain(before, best.trial), rivals),
             {}});
        ++n;
      }
      result.recordings = best.recordings;
      result.corrected = true;
      before = best.trial;
      if (noise_known && !(before.left > worth_looking)) break;
    }
    result.after = before.left;
    result.tried = trials.count;
  }
  // Where the better minimum explains the recordings, all is well.
  if (fit && !fit->better_start.empty())
    result.found.push_back({.kind = "local-minimum",
                            .statement = fit->better_start,
                            .note = fit->converged && fit->noise_known && fit->chi2_p > unlikely});
  if (fit && !fit->twin.empty())
    result.found.push_back({.kind = "twin-solution", .statement = fit->twin, .note = true});
  return result;
}

}  // namespace talus
