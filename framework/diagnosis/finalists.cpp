#include "framework/diagnosis/finalists.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "framework/diagnosis/screen_inside.h"

namespace talus {
namespace {

constexpr double kUnknownPrior = -4;   // ln prior odds of a curve without a cause
constexpr std::size_t kCompared = 64;  // of the best, which are told apart by these poses?
constexpr int kFormsOfEach = 3;        // where everything is tried
constexpr double kLooseCurve = 10;     // heights of a curve may be so many typical ones
constexpr double kClose = 30;          // ln of the evidence: worth a better setting
constexpr int kHalvings = 3;

// A form as the screening sees it.
struct Entry {
  const Score* score;
  int suspect;
  double evidence;
  double prior;  // ln, its share of the suspect and the change points included
};

class Chooser {
 public:
  Chooser(const Ground& ground, const Stage& stage, const Trial& base,
          const FinalistOptions& options)
      : ground_(ground), stage_(stage), base_(base), options_(options) {}

  Tried run() {
    const std::vector<Score> scores = stage_.screen.scores();
    std::vector<Entry> entries = ranked(scores);
    entries = options_.everything ? some_of_each(entries) : leading(entries);
    fit(entries);
    better_settings(entries);
    return sorted();
  }

 private:
  std::vector<Entry> ranked(const std::vector<Score>& scores) const {
    const Suspects& all = stage_.suspects;
    std::vector<int> forms(all.suspects.size(), 0);
    for (const Way& way : all.ways) ++forms[way.suspect];
    std::vector<Entry> entries;
    for (const Score& s : scores) {
      const int of = all.ways[s.pick.form].suspect;
      const Suspect& suspect = all.suspects[of];
      if (s.freedom == 0 || taken(base_, suspect) || !within_causes(suspect)) continue;
      double prior = (suspect.effect == "unknown" ? kUnknownPrior : 0) - std::log(forms[of]);
      if (s.pick.from >= 0) prior += s.log_bayes - stage_.screen.score(s.pick).log_bayes;
      entries.push_back({&s, of, s.log_bayes + prior, prior});
    }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.evidence > b.evidence; });
    return entries;
  }

  // Effects at work, each counted once wherever it acts; every curve of no known cause by itself.
  bool within_causes(const Suspect& s) const {
    std::set<std::string> causes;
    bool known = false;
    for (const Accepted& e : base_.effects) {
      const bool curve = e.suspect.effect == "unknown";
      causes.insert(e.suspect.effect + (curve ? e.suspect.at : ""));
      known |= !curve && e.suspect.plugin == s.plugin;
    }
    return known || causes.size() < static_cast<std::size_t>(options_.most_causes);
  }

  std::vector<Entry> leading(const std::vector<Entry>& entries) const {
    const auto& suspects = stage_.suspects.suspects;
    std::vector<Pick> picks;
    for (std::size_t i = 0; i < std::min(entries.size(), kCompared); ++i)
      picks.push_back(entries[i].score->pick);
    std::vector<int> kind(entries.size(), -1);
    const auto classes = stage_.screen.classes(picks);
    for (std::size_t c = 0; c < classes.size(); ++c)
      for (const int i : classes[c]) kind[i] = static_cast<int>(c);
    std::vector<Entry> result;
    std::vector<int> count(suspects.size(), 0);
    std::set<int> leaders;
    std::set<std::string> joints, places;
    const double top = entries.empty() ? 0 : entries[0].evidence;
    const auto most = static_cast<std::size_t>(2 * options_.leading);
    for (std::size_t i = 0; i < entries.size() && result.size() < most; ++i) {
      const Entry& e = entries[i];
      const Suspect& s = suspects[e.suspect];
      const bool leads =
          kind[i] >= 0 && e.evidence > top - std::max(25.0, 0.5 * std::abs(top)) &&
          (leaders.contains(kind[i]) || static_cast<int>(leaders.size()) < options_.leading);
      const bool neighbour = joints.contains(s.joint) && e.evidence > 0;
      if ((!leads && !neighbour) || ++count[e.suspect] > (leads ? 2 : 1)) continue;
      if (result.size() < 2 && !s.joint.empty()) joints.insert(s.joint), places.insert(s.at);
      if (leads) leaders.insert(kind[i]);
      result.push_back(e);
    }
    // Where the fit is impossible, even what does not look like it from there.
    if (stage_.studentised)
      for (const Entry& e : entries)
        if (places.contains(suspects[e.suspect].at) && count[e.suspect]++ == 0) result.push_back(e);
    return result;
  }

  // Of every suspect the forms that do best.
  static std::vector<Entry> some_of_each(const std::vector<Entry>& entries) {
    std::vector<Entry> result;
    std::map<int, int> count;
    for (const Entry& e : entries)
      if (++count[e.suspect] <= kFormsOfEach) result.push_back(e);
    return result;
  }

  void fit(const std::vector<Entry>& entries) {
    std::vector<std::vector<Accepted>> hypotheses(entries.size(), base_.effects);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      hypotheses[i].push_back(stage_.accepted(ground_, *entries[i].score));
      Accepted& e = hypotheses[i].back();
      if (e.suspect.effect == "unknown") e.scale = kLooseCurve;
      // Many amounts at once are held to the size that the rows speak for.
      if (options_.stiff && e.amounts.size() > 3) e.scale = entries[i].score->scale;
    }
    TrialOptions options;
    options.from_nominal = true;
    tried_.trials = fit_trials(ground_, hypotheses, base_, options);
    for (std::size_t i = 0; i < entries.size(); ++i)
      tried_.alternatives.push_back(judged(entries[i], tried_.trials[i]));
  }

  Alternative judged(const Entry& entry, Trial& trial) const {
    Accepted& effect = trial.effects.back();
    const Eigen::Map<const Eigen::VectorXd> amounts(
        effect.amounts.data(), static_cast<Eigen::Index>(effect.amounts.size()));
    effect.occam = entry.prior + std::min(stage_.screen.occam(entry.score->pick, amounts),
                                          occam_of_refit(effect));
    double evidence = effect.occam + (base_.cost2 - trial.cost2) / 2;
    if (!std::isfinite(evidence)) evidence = -1e300;
    return {effect, evidence, trial.cost2, 0};
  }

  // The same by the refit's own uncertainties, the amounts one by one: where large amounts and the
  // geometry together did what the screening, which is linear, did not see, these are known well
  // and must be paid for.
  double occam_of_refit(const Accepted& effect) const {
    const double noise = stage_.screen.inside().noise;
    const std::vector<double> scales = ScreenOptions().scales;
    std::vector<double> logs;
    for (const double c : scales) {
      double log = -std::log(static_cast<double>(scales.size()));
      for (std::size_t a = 0; a < effect.amounts.size(); ++a) {
        if (!(effect.std[a] > 0)) continue;
        const double ratio = std::pow(c * effect.way.typical[a] / effect.std[a], 2) / noise;
        const double size = std::pow(effect.amounts[a] / effect.std[a], 2) / noise;
        log -= (size / (1 + ratio) + std::log1p(ratio)) / 2;
      }
      logs.push_back(log);
    }
    return log_sum(logs);
  }

  // Half the mean distance of the values that were screened; 0 where only one was.
  double step_of(int suspect, const std::string& setting) const {
    std::set<double> values;
    for (const Way& way : stage_.suspects.ways)
      if (way.suspect == suspect && way.settings.contains(setting))
        values.insert(way.settings.at(setting));
    return values.size() < 2 ? 0
                             : (*values.rbegin() - *values.begin()) /
                                   (2 * static_cast<double>(values.size() - 1));
  }

  void better_settings(const std::vector<Entry>& entries) {
    double top = -1e300;
    for (const Alternative& a : tried_.alternatives) top = std::max(top, a.evidence);
    for (std::size_t i = 0; i < entries.size(); ++i)
      if (tried_.alternatives[i].evidence > top - kClose)
        for (const Input& input : tried_.alternatives[i].effect.suspect.plugin->declaration.inputs)
          if (input.role == Role::setting && input.relative)
            halve(entries[i], i, input.name, step_of(entries[i].suspect, input.name));
  }

  void halve(const Entry& entry, std::size_t i, const std::string& setting, double step) {
    if (!(step > 0)) return;
    for (int k = 0; k < kHalvings; ++k, step /= 2) {
      std::vector<std::vector<Accepted>> hypotheses(2, tried_.trials[i].effects);
      hypotheses[0].back().way.settings[setting] -= step;
      hypotheses[1].back().way.settings[setting] += step;
      std::vector<Trial> trials = fit_trials(ground_, hypotheses, tried_.trials[i]);
      Trial& better = trials[trials[1].cost2 < trials[0].cost2 ? 1 : 0];
      if (!(better.cost2 < tried_.trials[i].cost2)) continue;
      tried_.alternatives[i] = judged(entry, better);
      tried_.trials[i] = std::move(better);
    }
  }

  Tried sorted() {
    std::vector<std::size_t> order(tried_.trials.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return tried_.alternatives[a].evidence > tried_.alternatives[b].evidence;
    });
    Tried result;
    for (const std::size_t i : order) {
      result.alternatives.push_back(std::move(tried_.alternatives[i]));
      result.trials.push_back(std::move(tried_.trials[i]));
    }
    return result;
  }

  const Ground& ground_;
  const Stage& stage_;
  const Trial& base_;
  const FinalistOptions& options_;
  Tried tried_;
};

}  // namespace

void Tried::drop(std::size_t i) {
  alternatives.erase(alternatives.begin() + static_cast<std::ptrdiff_t>(i));
  trials.erase(trials.begin() + static_cast<std::ptrdiff_t>(i));
}

void Tried::put_first(std::size_t i) {
  auto turn = [i](auto& all) {
    const auto at = all.begin() + static_cast<std::ptrdiff_t>(i);
    std::rotate(all.begin(), at, at + 1);
  };
  turn(alternatives), turn(trials);
}

bool same_place(const Accepted& a, const Suspect& s) {
  return a.suspect.plugin == s.plugin && a.suspect.at == s.at;
}

bool taken(const Trial& trial, const Suspect& s) {
  return std::any_of(trial.effects.begin(), trial.effects.end(),
                     [&](const Accepted& a) { return same_place(a, s); });
}

Tried finalists(const Ground& ground, const Stage& stage, const Trial& base,
                const FinalistOptions& options) {
  return Chooser(ground, stage, base, options).run();
}

}  // namespace talus
