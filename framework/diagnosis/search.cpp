#include "framework/diagnosis/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "framework/diagnosis/tails.h"

namespace talus {
namespace {

constexpr double kLeastEvidence = 3;  // ln Bayes factor for an effect to be taken in
constexpr double kCertain = 30;  // the same where no gate was passed, but the fit is impossible
constexpr double kUnknownPrior = -4;  // ln prior odds of a curve without a cause
constexpr double kSwap = 3;           // ln by which a rival must be better
constexpr double kLeftover =
    0.15;                         // of all that was explained: less, beside a name, is its leftover
constexpr double kCoarse = 2.25;  // chi-square per degree of freedom: 1.5 sigmas
constexpr double kNearly = 0.85;  // of the gain of the first: explains nearly as much
constexpr int kOpenings = 2;
constexpr double kDropLogP = -6.9;  // a member whose loss costs less than this is dropped

bool same_place(const Accepted& a, const Suspect& s) {
  return a.suspect.plugin == s.plugin && a.suspect.at == s.at;
}

class Searcher {
 public:
  Searcher(const Ground& ground, const SearchOptions& options)
      : ground_(ground), options_(options), carry_over_(ground) {}

  Search run(const Trial& null) {
    result_.null = result_.best = null;
    grow(0);
    openings();
    leftovers();
    alternatives();
    return std::move(result_);
  }

 private:
  // Takes effects in, one by one, beside those that the result has.
  void grow(int first) {
    for (int round = first; members() < options_.most_members; ++round) {
      auto stage = std::make_shared<Stage>(stage_of(ground_, result_.best, stage_options()));
      if (round == 0) result_.stage = stage;
      result_.last = stage;
      GateOptions gate_options;
      gate_options.alpha = round == 0 ? options_.alpha_first : options_.alpha_later;
      gate_options.seed = options_.seed + static_cast<std::uint64_t>(round);
      gate_options.threads = ground_.threads;
      gate_options.studentised = stage->studentised;
      Gate gate = stage->screen.gate(gate_options);
      if (round == 0) result_.first = gate;
      std::vector<Alternative> tried;
      if (gate.open) tried = finalists(*stage, result_.best);
      if (stage->studentised) unbent(tried);
      // By the noise that the best of them leaves, where that is more than stated.
      const double left =
          tried.empty() ? 1 : std::max(1.0, tried[0].cost2 / std::max(1.0, stage->dof));
      const double least = gate.open ? kLeastEvidence : kCertain;
      if (stage->studentised) without_leftovers(tried);
      names_first(tried, result_.best, least * left);
      while (!tried.empty() && tried[0].evidence / left >= least &&
             !carries_over(*stage, trials_[0], result_.best))
        tried.erase(tried.begin()), trials_.erase(trials_.begin());
      if (tried.empty() || tried[0].evidence / left < least) break;
      // Without the gate the odds against nothing, over all that was tried, bound the chance.
      if (!gate.open) gate.family_p = std::exp(-tried[0].evidence / left) * gate.tests;
      if (round == 0) first_tried_ = tried, first_trials_ = trials_;
      result_.best = trials_[0];
      result_.members.push_back({0, gate, std::move(tried)});
      if (round > 0) backward(), swaps();
      if (options_.most_members > 1) complete(gate);
      if (!seen_.insert(signature()).second) break;  // it turns in a circle
      progress("searching", std::min(1.0, (round + 1.0) / options_.most_effects));
    }
  }

  // At the joint of a named effect, what explains much less than it does makes up for its formula,
  // which need not be quite right where the noise does not explain the rest.
  void without_leftovers(std::vector<Alternative>& tried) {
    const double little = kLeftover * (result_.null.cost2 - result_.best.cost2);
    for (std::size_t i = tried.size(); i-- > 0;) {
      const Suspect& s = tried[i].effect.suspect;
      const bool beside =
          !s.joint.empty() && std::any_of(result_.best.effects.begin(), result_.best.effects.end(),
                                          [&](const Accepted& e) {
                                            return e.suspect.effect != "unknown" &&
                                                   e.suspect.plugin != s.plugin &&
                                                   e.suspect.joint == s.joint;
                                          });
      if (!beside || result_.best.cost2 - tried[i].cost2 >= little) continue;
      tried.erase(tried.begin() + static_cast<long>(i));
      trials_.erase(trials_.begin() + static_cast<long>(i));
    }
  }

  // Does even this leave far more than the noise? Then no formula is exact here.
  bool coarse(double cost2) const { return cost2 > kCoarse * std::max(1.0, result_.last->dof); }

  // Where even the best curve is not exact, a name that leaves it less than it would leave beside
  // it (leftovers) goes first.
  void names_first(std::vector<Alternative>& tried, const Trial& base, double least) {
    if (tried.empty() || tried[0].effect.suspect.effect != "unknown" || !coarse(tried[0].cost2))
      return;
    const double gain = base.cost2 - tried[0].cost2;
    for (std::size_t i = 1; i < tried.size(); ++i)
      if (tried[i].effect.suspect.effect != "unknown" && tried[i].evidence >= least &&
          base.cost2 - tried[i].cost2 > (1 - kLeftover) * gain) {
        std::rotate(tried.begin(), tried.begin() + static_cast<long>(i),
                    tried.begin() + static_cast<long>(i) + 1);
        std::rotate(trials_.begin(), trials_.begin() + static_cast<long>(i),
                    trials_.begin() + static_cast<long>(i) + 1);
        return;
      }
  }

  // A formula with more freedom may do the work of two effects, better than either of them alone.
  // So simpler ones that explain nearly as much are tried as the first as well.
  void openings() {
    if (options_.most_members == 1 || result_.best.effects.empty()) return;
    const Search found = result_;
    const double first_gain = result_.null.cost2 - first_tried_[0].cost2;
    const std::size_t first_amounts = first_tried_[0].effect.amounts.size();
    int count = 0;
    for (std::size_t i = 1; i < first_tried_.size() && count < kOpenings; ++i) {
      const Alternative& a = first_tried_[i];
      if (a.effect.suspect.effect == "unknown" || a.effect.amounts.size() >= first_amounts ||
          taken(found.best, a.effect.suspect) ||
          result_.null.cost2 - a.cost2 < kNearly * first_gain)
        continue;
      ++count;
      Search kept = std::move(result_);
      result_ = found;
      result_.best = first_trials_[i];
      result_.members = {{0, found.members[0].gate, {a}}};
      seen_ = {signature()};
      grow(1);
      const double left = std::max(
          1.0, std::min(kept.best.cost2, result_.best.cost2) / std::max(1.0, kept.last->dof));
      auto odds = [&](const Trial& t) {
        double sum = -t.cost2 / 2;
        for (const Accepted& e : t.effects) sum += e.occam;
        return sum / left;
      };
      if (odds(result_.best) < odds(kept.best)) result_ = std::move(kept);
    }
  }

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

  StageOptions stage_options() const { return {options_.suspects}; }

  int members() const { return static_cast<int>(result_.best.effects.size()); }

  // The same of a rival: it must not predict worse.
  bool predicts(const Stage& stage, const Trial& rival, const Trial& member) const {
    return !stage.studentised ||
           !(carry_over_.predicted(rival).sum() > carry_over_.predicted(member).sum());
  }

  // Effects at work, each counted once wherever it acts; every curve of no known cause by itself.
  static std::size_t causes(const Trial& trial) {
    std::set<std::string> tags;
    for (const Accepted& e : trial.effects)
      tags.insert(e.suspect.effect + (e.suspect.effect == "unknown" ? e.suspect.at : ""));
    return tags.size();
  }
  bool within_causes(const Trial& base, const Suspect& s) const {
    if (causes(base) < static_cast<std::size_t>(options_.most_effects)) return true;
    return s.effect != "unknown" &&
           std::any_of(base.effects.begin(), base.effects.end(),
                       [&](const Accepted& e) { return e.suspect.plugin == s.plugin; });
  }

  // Where the noise makes the fit impossible, does the longer hypothesis predict rows better?
  bool carries_over(const Stage& stage, const Trial& longer, const Trial& shorter) const {
    if (!stage.studentised) return true;
    return CarryOver::better(carry_over_.predicted(longer), carry_over_.predicted(shorter));
  }

  void progress(const std::string& step, double share) const {
    if (options_.progress) options_.progress(step, share);
  }

  // The most promising candidates beside a hypothesis, fitted for real; the best first.
  std::vector<Alternative> finalists(const Stage& stage, const Trial& base) {
    const std::vector<Score> scores = stage.screen.scores();
    const std::vector<SuspectScore> ranking = stage.screen.suspects();
    struct Entry {
      const Score* score;
      double evidence;
    };
    std::vector<Entry> entries;
    std::vector<double> of_suspect(stage.suspects.suspects.size(), 0);
    std::vector<int> forms(stage.suspects.suspects.size(), 0);
    for (const Way& way : stage.suspects.ways) ++forms[way.suspect];
    for (const SuspectScore& s : ranking) of_suspect[s.suspect] = s.log_bayes;
    for (const Score& s : scores) {
      const Way& way = stage.suspects.ways[s.pick.form];
      const Suspect& suspect = stage.suspects.suspects[way.suspect];
      if (s.freedom == 0 || taken(base, suspect) || !within_causes(base, suspect)) continue;
      const double prior = suspect.effect == "unknown" ? kUnknownPrior : 0;
      entries.push_back({&s, s.log_bayes - std::log(forms[way.suspect]) + prior});
    }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.evidence > b.evidence; });
    std::vector<std::vector<Accepted>> hypotheses;
    std::vector<Alternative> result;
    std::vector<int> count(stage.suspects.suspects.size(), 0);
    const double top = entries.empty() ? 0 : entries[0].evidence;
    auto add = [&](const Entry& e) {
      hypotheses.push_back(base.effects);
      hypotheses.back().push_back(stage.accepted(ground_, *e.score));
      // Occam's term of the screening, the gain of the refit.
      const double occam = e.evidence - e.score->all / 2;
      hypotheses.back().back().occam = occam;
      result.push_back({hypotheses.back().back(), occam, 0, 0});
    };
    std::set<std::string> places;
    for (const Entry& e : entries) {
      const int s = stage.suspects.ways[e.score->pick.form].suspect;
      const std::string& joint = stage.suspects.suspects[s].joint;
      const bool leading = static_cast<int>(result.size()) < options_.finalists &&
                           e.evidence > top - std::max(25.0, 0.5 * std::abs(top));
      // At the places of the first, everything that can act there: screening goes by a geometry
      // that the missing effect has bent.
      const bool neighbour = places.contains(joint) && e.evidence > 0;
      if ((!leading && !neighbour) || ++count[s] > (leading ? 2 : 1)) continue;
      if (result.size() < 2 && !joint.empty()) places.insert(joint);
      add(e);
      if (static_cast<int>(result.size()) >= 2 * options_.finalists) break;
    }
    trials_.clear();
    if (hypotheses.empty()) return {};
    TrialOptions trial_options;
    trial_options.from_nominal = true;
    std::vector<Trial> trials = fit_trials(ground_, hypotheses, base, trial_options);
    for (std::size_t i = 0; i < trials.size(); ++i) {
      result[i].cost2 = trials[i].cost2;
      result[i].evidence += (base.cost2 - trials[i].cost2) / 2;
      if (!std::isfinite(result[i].evidence)) result[i].evidence = -1e300;
      result[i].effect = trials[i].effects.empty() ? result[i].effect : trials[i].effects.back();
    }
    std::vector<std::size_t> order(result.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return result[a].evidence > result[b].evidence;
    });
    std::vector<Alternative> sorted;
    for (std::size_t i : order) {
      sorted.push_back(std::move(result[i]));
      trials_.push_back(std::move(trials[i]));
    }
    return sorted;
  }

  static bool taken(const Trial& trial, const Suspect& s) {
    return std::any_of(trial.effects.begin(), trial.effects.end(),
                       [&](const Accepted& a) { return same_place(a, s); });
  }

  // What is missing may have bent the geometry so far that nothing is seen from there: screening
  // from the nominal geometry as well. Its finalists take the others' place where they do better.
  void unbent(std::vector<Alternative>& tried) {
    std::vector<Trial> kept = std::move(trials_);
    Trial nominal;
    nominal.effects = result_.best.effects;
    for (const auto& [name, value] : result_.best.values)
      if (!result_.null.values.contains(name)) nominal.values[name] = value;
    std::vector<Alternative> others =
        finalists(stage_of(ground_, nominal, stage_options()), result_.best);
    if (!others.empty() && (tried.empty() || others[0].evidence > tried[0].evidence + kSwap))
      tried = std::move(others);
    else
      trials_ = std::move(kept);
  }

  std::vector<Accepted> without(std::size_t i) const {
    std::vector<Accepted> rest = result_.best.effects;
    rest.erase(rest.begin() + static_cast<long>(i));
    return rest;
  }

  void backward() {
    for (std::size_t i = 0; i < result_.best.effects.size();) {
      const Trial rest = fit_trial(ground_, without(i), result_.best);
      const double loss = rest.cost2 - result_.best.cost2,
                   freedom = static_cast<double>(result_.best.effects[i].amounts.size());
      const double leftover = std::max(1.0, result_.best.cost2 / std::max(1.0, result_.last->dof));
      if (log_chi2_tail(std::max(0.0, loss / leftover), freedom) > kDropLogP) {
        result_.best = rest;
        result_.members.erase(result_.members.begin() + static_cast<long>(i));
      } else {
        ++i;
      }
    }
  }

  void swaps() {
    for (std::size_t i = 0; i < result_.best.effects.size(); ++i) {
      const Trial rest = fit_trial(ground_, without(i), result_.best);
      const Stage stage = stage_of(ground_, rest, stage_options());
      std::vector<Alternative> tried = finalists(stage, rest);
      if (tried.empty()) continue;
      double own = -std::numeric_limits<double>::infinity();
      for (const Alternative& a : tried)
        if (same_place(a.effect, result_.best.effects[i].suspect)) own = std::max(own, a.evidence);
      names_first(tried, rest, kLeastEvidence);
      if (tried[0].evidence > own + kSwap && predicts(stage, trials_[0], result_.best)) {
        result_.best = std::move(trials_[0]);
        std::rotate(result_.best.effects.begin() + static_cast<long>(i),
                    result_.best.effects.end() - 1, result_.best.effects.end());
      }
    }
  }

  // An effect at work at several places is tried at all others of its kind together. What chance
  // would do by itself is dropped again.
  void complete(const Gate& gate) {
    std::map<const Plugin*, int> places;
    for (const Accepted& e : result_.best.effects)
      if (e.suspect.effect != "unknown") ++places[e.suspect.plugin];
    std::erase_if(places, [](const auto& p) { return p.second < 2; });
    for (const auto& [plugin, count] : places) {
      const Stage stage = stage_of(ground_, result_.best, stage_options());
      const std::vector<Score> scores = stage.screen.scores();
      std::map<int, std::pair<double, const Score*>> best;  // of each suspect
      for (const Score& s : scores) {
        const Suspect& suspect = stage.suspects.suspects[stage.suspects.ways[s.pick.form].suspect];
        if (suspect.plugin != plugin || s.freedom == 0 || taken(result_.best, suspect)) continue;
        auto& [evidence, score] = best[stage.suspects.ways[s.pick.form].suspect];
        if (!score || s.log_bayes > evidence) evidence = s.log_bayes, score = &s;
      }
      if (best.empty()) continue;
      std::vector<Accepted> effects = result_.best.effects;
      double occam = 0;
      std::vector<Alternative> each;
      for (const auto& [suspect, found] : best) {
        effects.push_back(stage.accepted(ground_, *found.second));
        effects.back().occam = found.first - found.second->all / 2;
        each.push_back({effects.back(), 0, 0, 0});
        occam += effects.back().occam;
      }
      Trial all = fit_trial(ground_, effects, result_.best);
      const double left = std::max(1.0, all.cost2 / std::max(1.0, stage.dof));
      const double gain = result_.best.cost2 - all.cost2;
      if (gain / 2 / left + occam < kLeastEvidence || !carries_over(stage, all, result_.best))
        continue;
      result_.best = std::move(all);
      for (Alternative& a : each) result_.members.push_back({0, gate, {std::move(a)}});
      backward();
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
        const Trial rest = fit_trial(ground_, without(i), result_.best);
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
      if (effects.size() > 1 || m.alternatives.empty()) {
        rest = fit_trial(ground_, without(i), result_.best);
        const Stage stage = stage_of(ground_, rest, stage_options());
        m.alternatives = finalists(stage, rest);
      }
      m.gain = rest.cost2 - result_.best.cost2;
      // A curve that does little more than a name takes up what its formula leaves.
      const double little = kLeftover * (result_.null.cost2 - result_.best.cost2);
      if (effects[i].suspect.effect != "unknown" && coarse(result_.best.cost2))
        std::erase_if(m.alternatives, [&](const Alternative& a) {
          return a.effect.suspect.effect == "unknown" && a.cost2 > result_.best.cost2 - little;
        });
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
    const double left =
        std::max(1.0, result_.best.chi2 / std::max(1.0, result_.last ? result_.last->dof : 1.0));
    double sum = 0;
    for (Alternative& a : all)
      sum += a.probability = std::exp((a.evidence - all[0].evidence) / left);
    for (Alternative& a : all) a.probability /= sum;
  }

  const Ground& ground_;
  const SearchOptions& options_;
  Search result_;
  CarryOver carry_over_;
  std::vector<Trial> trials_;             // of the finalists, in their order
  std::vector<Alternative> first_tried_;  // those of the first round, and their fits
  std::vector<Trial> first_trials_;
  std::set<std::string> seen_;
};

}  // namespace

Search search(const Ground& ground, const Trial& null, const SearchOptions& options) {
  return Searcher(ground, options).run(null);
}

}  // namespace talus
