#include "framework/diagnosis/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "framework/diagnosis/tails.h"

namespace talus {
namespace {

constexpr double kLeastEvidence = 3;  // ln Bayes factor for an effect to be taken in
constexpr double kCertain = 30;  // the same where no gate was passed, but the fit is impossible
constexpr double kUnknownPrior = -4;  // ln prior odds of a curve without a cause
constexpr double kChance = -4.6;      // ln of the chance that is borne with, all candidates counted
constexpr double kSwap = 3;           // ln by which a rival must be better
constexpr double kLeftover = 0.15;  // share of all explained: less, beside a name, is its leftover
constexpr std::size_t kCompared = 64;  // of the best, which are told apart by these poses?
constexpr int kFormsOfEach = 3;        // where everything is tried
constexpr double kDropLogP = -6.9;     // a member whose loss costs less than this is dropped

bool same_place(const Accepted& a, const Suspect& s) {
  return a.suspect.plugin == s.plugin && a.suspect.at == s.at;
}

std::vector<Accepted> without(const Trial& trial, std::size_t i) {
  std::vector<Accepted> rest = trial.effects;
  rest.erase(rest.begin() + static_cast<long>(i));
  return rest;
}

class Searcher {
 public:
  Searcher(const Ground& ground, const SearchOptions& options)
      : ground_(ground), options_(options) {}

  Search run(const Trial& null) {
    result_.null = result_.best = null;
    for (int round = 0; round < options_.most_effects; ++round) {
      auto stage = std::make_shared<Stage>(stage_of(ground_, result_.best, stage_options()));
      if (round == 0) result_.stage = stage;
      GateOptions gate_options;
      gate_options.alpha = round == 0 ? options_.alpha_first : options_.alpha_later;
      gate_options.seed = options_.seed + static_cast<std::uint64_t>(round);
      gate_options.threads = ground_.threads;
      gate_options.studentised = stage->studentised;
      Gate gate = stage->screen.gate(gate_options);
      if (round == 0) result_.first = gate;
      std::vector<Alternative> tried;
      if (gate.open) tried = finalists(*stage, result_.best);
      if (stage->studentised) unbent(gate.open, tried);
      const double least = gate.open ? kLeastEvidence : kCertain;
      if (!convincing(tried, least) && stage->studentised) tried = everything();
      if (!convincing(tried, least)) break;
      // Without the gate the odds against nothing, over all that was tried, bound the chance.
      if (!gate.open)
        gate.family_p = std::exp(-tried[0].evidence / left_by(best_trial_)) * gate.tests;
      result_.best = std::move(best_trial_);
      result_.members.push_back({0, gate, std::move(tried)});
      ++rounds_;
      if (round > 0) backward(), swaps();
      if (!seen_.insert(signature()).second) break;  // it turns in a circle
      progress("searching", (round + 1.0) / options_.most_effects);
    }
    leftovers();
    result_.left = left_by(result_.best);
    alternatives();
    return std::move(result_);
  }

 private:
  // Which effects, where and how.
  std::string signature() const {
    std::vector<std::string> parts;
    for (const Accepted& e : result_.best.effects) {
      parts.push_back(e.suspect.effect + "@" + e.suspect.at + ":" + e.way.driver);
      for (const auto& [name, value] : e.way.settings)
        parts.back() += fmt::format(",{}={}", name, value);
    }
    std::sort(parts.begin(), parts.end());
    return join(parts);
  }

  // The variance that a hypothesis leaves; where it is stated, at least that.
  double left_by(const Trial& trial) const {
    double dof = result_.stage->dof;
    for (const Accepted& e : trial.effects) dof -= static_cast<double>(e.amounts.size());
    const double left = trial.cost2 / std::max(1.0, dof);
    return ground_.scale.empty() ? std::max(1.0, left) : left;
  }

  StageOptions stage_options() const { return {options_.suspects}; }

  void progress(const std::string& step, double share) const {
    if (options_.progress) options_.progress(step, share);
  }

  // A form as the screening sees it.
  struct Entry {
    const Score* score;
    int suspect;
    double evidence;
    double prior;  // ln, its share of the suspect and the change points included
  };

  std::vector<Entry> ranked(const Stage& stage, const std::vector<Score>& scores,
                            const Trial& base) const {
    std::vector<int> forms(stage.suspects.suspects.size(), 0);
    for (const Way& way : stage.suspects.ways) ++forms[way.suspect];
    std::vector<Entry> entries;
    for (const Score& s : scores) {
      const int of = stage.suspects.ways[s.pick.form].suspect;
      const Suspect& suspect = stage.suspects.suspects[of];
      if (s.freedom == 0 || taken(base, suspect)) continue;
      double prior = (suspect.effect == "unknown" ? kUnknownPrior : 0) - std::log(forms[of]);
      if (s.pick.from >= 0) prior += s.log_bayes - stage.screen.score(s.pick).log_bayes;
      entries.push_back({&s, of, s.log_bayes + prior, prior});
    }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.evidence > b.evidence; });
    return entries;
  }

  // The leading entries, and what else can act at the places of the first: screening goes by a
  // geometry that the missing effect has bent.
  std::vector<Entry> leading(const Stage& stage, const std::vector<Entry>& entries) const {
    std::vector<Pick> picks;
    for (std::size_t i = 0; i < std::min(entries.size(), kCompared); ++i)
      picks.push_back(entries[i].score->pick);
    // What no recordings of these poses tell apart takes one place among the leading.
    std::vector<int> kind(entries.size(), -1);
    const auto classes = stage.screen.classes(picks);
    for (std::size_t c = 0; c < classes.size(); ++c)
      for (const int i : classes[c]) kind[i] = static_cast<int>(c);
    std::vector<Entry> result;
    std::vector<int> count(stage.suspects.suspects.size(), 0);
    std::set<int> leaders;
    std::set<std::string> places;
    const double top = entries.empty() ? 0 : entries[0].evidence;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const Entry& e = entries[i];
      const std::string& joint = stage.suspects.suspects[e.suspect].joint;
      const bool leads =
          kind[i] >= 0 && e.evidence > top - std::max(25.0, 0.5 * std::abs(top)) &&
          (leaders.contains(kind[i]) || static_cast<int>(leaders.size()) < options_.finalists);
      const bool neighbour = places.contains(joint) && e.evidence > 0;
      if ((!leads && !neighbour) || ++count[e.suspect] > (leads ? 2 : 1)) continue;
      if (result.size() < 2 && !joint.empty()) places.insert(joint);
      if (leads) leaders.insert(kind[i]);
      result.push_back(e);
      if (static_cast<int>(result.size()) >= 2 * options_.finalists) break;
    }
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

  // The most promising candidates beside a hypothesis, or some forms of each, fitted for real; the
  // best first.
  std::vector<Alternative> finalists(const Stage& stage, const Trial& base, bool all = false) {
    const std::vector<Score> scores = stage.screen.scores();
    std::vector<Entry> entries = ranked(stage, scores, base);
    entries = all ? some_of_each(entries) : leading(stage, entries);
    if (entries.empty()) return {};
    std::vector<std::vector<Accepted>> hypotheses(entries.size(), base.effects);
    for (std::size_t i = 0; i < entries.size(); ++i)
      hypotheses[i].push_back(stage.accepted(ground_, *entries[i].score));
    TrialOptions trial_options;
    trial_options.from_nominal = true;
    std::vector<Trial> trials = fit_trials(ground_, hypotheses, base, trial_options);
    std::vector<Alternative> result;
    std::size_t best = 0;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      const Accepted& effect = trials[i].effects.back();
      const Eigen::Map<const Eigen::VectorXd> amounts(
          effect.amounts.data(), static_cast<Eigen::Index>(effect.amounts.size()));
      double evidence = entries[i].prior + stage.screen.occam(entries[i].score->pick, amounts) +
                        (base.cost2 - trials[i].cost2) / 2;
      if (!std::isfinite(evidence)) evidence = -1e300;
      result.push_back({effect, evidence, trials[i].cost2, 0});
      if (evidence > result[best].evidence) best = i;
    }
    best_trial_ = trials[best];
    std::stable_sort(result.begin(), result.end(), [](const Alternative& a, const Alternative& b) {
      return a.evidence > b.evidence;
    });
    return result;
  }

  static bool taken(const Trial& trial, const Suspect& s) {
    return std::any_of(trial.effects.begin(), trial.effects.end(),
                       [&](const Accepted& a) { return same_place(a, s); });
  }

  // What is missing may have bent the geometry so far that nothing is seen from there: screening
  // from the nominal geometry as well. Its finalists take the others' place where they do better.
  void unbent(bool open, std::vector<Alternative>& tried) {
    const Trial kept = open ? best_trial_ : Trial{};
    std::vector<Alternative> others = finalists(at_nominal(), result_.best);
    if (!others.empty() && (tried.empty() || others[0].evidence > tried[0].evidence + kSwap))
      tried = std::move(others);
    else
      best_trial_ = kept;
  }

  // Where the fit is impossible and no promising candidate explains it: each that there is.
  std::vector<Alternative> everything() {
    progress("trying every candidate", 0);
    return finalists(at_nominal(), result_.best, true);
  }

  // What was accepted, with the geometry as it was before any fit.
  Stage at_nominal() const {
    Trial nominal;
    nominal.effects = result_.best.effects;
    for (const auto& [name, value] : result_.best.values)
      if (!result_.null.values.contains(name)) nominal.values[name] = value;
    return stage_of(ground_, nominal, stage_options());
  }

  // By the noise that the best of them leaves, where that is more than stated.
  bool convincing(const std::vector<Alternative>& tried, double least) const {
    return !tried.empty() && tried[0].evidence / left_by(best_trial_) >= least;
  }

  void backward() {
    for (std::size_t i = 0; i < result_.best.effects.size();) {
      const Trial rest = fit_trial(ground_, without(result_.best, i), result_.best);
      const double loss = rest.cost2 - result_.best.cost2,
                   freedom = static_cast<double>(result_.best.effects[i].amounts.size());
      if (log_chi2_tail(std::max(0.0, loss / left_by(result_.best)), freedom) > kDropLogP) {
        result_.best = rest;
        result_.members.erase(result_.members.begin() + static_cast<long>(i));
      } else {
        ++i;
      }
    }
  }

  void swaps() {
    for (std::size_t i = 0; i < result_.best.effects.size(); ++i) {
      const Trial rest = fit_trial(ground_, without(result_.best, i), result_.best);
      const Stage stage = stage_of(ground_, rest, stage_options());
      std::vector<Alternative> tried = finalists(stage, rest);
      if (tried.empty()) continue;
      double own = -std::numeric_limits<double>::infinity();
      for (const Alternative& a : tried)
        if (same_place(a.effect, result_.best.effects[i].suspect)) own = std::max(own, a.evidence);
      if (tried[0].evidence > own + kSwap) {
        result_.best = best_trial_;
        std::rotate(result_.best.effects.begin() + static_cast<long>(i),
                    result_.best.effects.end() - 1, result_.best.effects.end());
      }
    }
  }

  // A named effect whose formula is not quite right leaves something at its place, which a curve
  // takes up. The name stands, the curve is not a finding.
  void leftovers() {
    for (std::size_t i = 0; i < result_.best.effects.size();) {
      const Suspect& curve = result_.best.effects[i].suspect;
      const bool beside =
          curve.effect == "unknown" && !curve.joint.empty() &&
          std::any_of(result_.best.effects.begin(), result_.best.effects.end(),
                      [&](const Accepted& e) {
                        return e.suspect.effect != "unknown" && e.suspect.joint == curve.joint;
                      });
      if (beside) {
        const Trial rest = fit_trial(ground_, without(result_.best, i), result_.best);
        if (rest.cost2 - result_.best.cost2 <
            kLeftover * (result_.null.cost2 - result_.best.cost2)) {
          result_.best = rest;
          result_.members.erase(result_.members.begin() + static_cast<long>(i));
          continue;
        }
      }
      ++i;
    }
  }

  // Of each member, what else could stand in its place.
  void alternatives() {
    const auto& effects = result_.best.effects;
    for (std::size_t i = 0; i < effects.size(); ++i) {
      Member& m = result_.members[i];
      Trial rest = result_.null;
      if (effects.size() > 1 || rounds_ > 1) {
        rest = fit_trial(ground_, without(result_.best, i), result_.best);
        const Stage stage = stage_of(ground_, rest, stage_options());
        m.alternatives = finalists(stage, rest);
      }
      m.gain = rest.cost2 - result_.best.cost2;
      probabilities(m.alternatives);
      progress("rivals", (i + 1.0) / static_cast<double>(effects.size()));
    }
  }

  void probabilities(std::vector<Alternative>& all) const {
    if (all.empty()) return;
    // One entry per suspect: its best way.
    std::vector<Alternative> merged;
    for (Alternative& a : all)
      if (std::none_of(merged.begin(), merged.end(), [&](const Alternative& m) {
            return same_place(m.effect, a.effect.suspect);
          }))
        merged.push_back(a);
    all = std::move(merged);
    // Where even the best leaves more than the noise, differences count for less.
    double sum = 0;
    for (Alternative& a : all)
      sum += a.probability = std::exp((a.evidence - all[0].evidence) / result_.left);
    for (Alternative& a : all) a.probability /= sum;
  }

  const Ground& ground_;
  const SearchOptions& options_;
  Search result_;
  Trial best_trial_;
  std::set<std::string> seen_;
  int rounds_ = 0;  // in which an effect was taken in
};

}  // namespace

int discount(const Ground& ground, Search& search, double factor) {
  int dropped = 0;
  while (!search.best.effects.empty()) {
    std::vector<Trial> rests;
    std::size_t weakest = 0;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < search.best.effects.size(); ++i) {
      rests.push_back(fit_trial(ground, without(search.best, i), search.best));
      const double gain = rests[i].cost2 - search.best.cost2;
      search.members[i].gain = gain;
      const double log_p =
          log_chi2_tail(std::max(0.0, gain * factor / search.left),
                        static_cast<double>(search.best.effects[i].amounts.size()));
      if (log_p > most) most = log_p, weakest = i;
    }
    if (most + std::log(std::max(1, search.first.tests)) < kChance) break;
    search.best = std::move(rests[weakest]);
    search.members.erase(search.members.begin() + static_cast<long>(weakest));
    ++dropped;
  }
  return dropped;
}

Search search(const Ground& ground, const Trial& null, const SearchOptions& options) {
  return Searcher(ground, options).run(null);
}

}  // namespace talus
