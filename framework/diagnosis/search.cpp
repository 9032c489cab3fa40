#include "framework/diagnosis/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "framework/diagnosis/tails.h"

namespace talus {
namespace {

constexpr double kLeastEvidence = 3;  // ln Bayes factor for an effect to be taken in
constexpr double kCertain = 30;     // the same where no gate was passed, but the fit is impossible
constexpr double kChance = -4.6;    // ln of the chance that is borne with, all candidates counted
constexpr double kSwap = 3;         // ln by which a rival must be better
constexpr double kLeftover = 0.15;  // share of all explained: less, beside a name, is its leftover
constexpr double kCoarse = 2.25;    // chi-square per degree of freedom: 1.5 sigmas
constexpr double kNearly = 0.85;    // of the gain of the first: explains nearly as much
constexpr int kOpenings = 2;
constexpr double kDropLogP = -6.9;  // a member whose loss costs less than this is dropped

bool unknown(const Accepted& e) { return e.suspect.effect == "unknown"; }

std::vector<Accepted> without(const Trial& trial, std::size_t i) {
  std::vector<Accepted> rest = trial.effects;
  rest.erase(rest.begin() + static_cast<long>(i));
  return rest;
}

class Searcher {
 public:
  // exact: some combination of formulas may leave nothing but the noise.
  Searcher(const Ground& ground, const SearchOptions& options, bool exact)
      : ground_(ground), options_(options), exact_(exact) {
    if (!exact) carry_over_.emplace(ground);
  }

  Search run(const Trial& null) {
    result_.null = result_.best = null;
    grow(0);
    openings();
    leftovers();
    if (!exact_) refine();
    result_.left = left_by(result_.best);
    result_.exact = exact_;
    alternatives();
    return std::move(result_);
  }

  // What else could stand in the place of each member, anew.
  Search weighed_again(Search found) {
    result_ = std::move(found);
    result_.left = left_by(result_.best);
    rounds_ = 2;
    alternatives();
    return std::move(result_);
  }

 private:
  // Takes effects in, one by one, beside those that the result has.
  void grow(int first) {
    const int most = exact_ ? options_.most_effects : options_.most_members;
    for (int round = first; exact_ ? round < most : members() < most; ++round) {
      auto stage = std::make_shared<Stage>(stage_of(ground_, result_.best, {options_.suspects}));
      if (round == 0) result_.stage = stage;
      Gate gate = gate_of(*stage, round);
      if (round == 0) result_.first = gate;
      Tried tried;
      if (gate.open) tried = finalists_at(*stage, result_.best);
      if (stage->studentised) unbent(tried);
      const double least = gate.open ? kLeastEvidence : kCertain;
      if (!convincing(tried, least) && stage->studentised) tried = everything();
      if (!exact_) {
        names_first(tried, result_.best, least);
        while (convincing(tried, least) && !carries_over(*stage, tried.trials[0], result_.best))
          tried.drop(0);
      }
      if (!convincing(tried, least)) break;
      // Without the gate the odds against nothing, over all that was tried, bound the chance.
      if (!gate.open) gate.family_p = std::exp(-evidence_of(tried)) * gate.tests;
      if (round == 0) first_ = tried;
      result_.best = tried.trials[0];
      result_.members.push_back({0, gate, std::move(tried.alternatives)});
      if (round > 0) backward(), swaps();
      if (!exact_) complete(gate);
      ++rounds_;
      if (!seen_.insert(signature()).second) break;  // it turns in a circle
      progress("searching", std::min(1.0, (round + 1.0) / options_.most_effects));
    }
  }

  Gate gate_of(const Stage& stage, int round) const {
    GateOptions options;
    options.alpha = round == 0 ? options_.alpha_first : options_.alpha_later;
    options.seed = options_.seed + static_cast<std::uint64_t>(round);
    options.threads = ground_.threads;
    options.studentised = stage.studentised;
    return stage.screen.gate(options);
  }

  // The variance that a hypothesis leaves; where it is stated, at least that.
  double left_by(const Trial& trial) const {
    double dof = result_.stage->dof;
    for (const Accepted& e : trial.effects) dof -= static_cast<double>(e.amounts.size());
    const double left = trial.cost2 / std::max(1.0, dof);
    return ground_.scale.empty() ? std::max(1.0, left) : left;
  }

  // Of the best, by the noise that it leaves where that is more than stated.
  double evidence_of(const Tried& tried) const {
    return tried.best().evidence / left_by(tried.trials[0]);
  }
  bool convincing(const Tried& tried, double least) const {
    return !tried.empty() && evidence_of(tried) >= least;
  }

  Tried finalists_at(const Stage& stage, const Trial& base, bool everything = false) const {
    const int causes = exact_ ? options_.most_effects : options_.most_causes;
    return finalists(ground_, stage, base, {options_.finalists, causes, everything, !exact_});
  }

  // What is missing may have bent the geometry so far that nothing is seen from there: screening
  // from the nominal geometry as well. Its finalists take the others' place where they do better.
  void unbent(Tried& tried) const {
    Tried others = finalists_at(at_nominal(), result_.best);
    if (!others.empty() &&
        (tried.empty() || others.best().evidence > tried.best().evidence + kSwap))
      tried = std::move(others);
  }

  // Where the fit is impossible and no promising candidate explains it: each that there is.
  Tried everything() const {
    progress("trying every candidate", 0);
    return finalists_at(at_nominal(), result_.best, true);
  }

  // What was accepted, with the geometry as it was before any fit.
  Stage at_nominal() const {
    Trial nominal;
    nominal.effects = result_.best.effects;
    for (const auto& [name, value] : result_.best.values)
      if (!result_.null.values.contains(name)) nominal.values[name] = value;
    return stage_of(ground_, nominal, {options_.suspects});
  }

  bool coarse(const Trial& trial) const { return left_by(trial) > kCoarse; }

  // Where even the best curve is not exact, a name that leaves it less than it would leave beside
  // it (leftovers) goes first.
  void names_first(Tried& tried, const Trial& base, double least) const {
    if (tried.empty() || !unknown(tried.best().effect) || !coarse(tried.trials[0])) return;
    const double gain = base.cost2 - tried.best().cost2, left = left_by(tried.trials[0]);
    for (std::size_t i = 1; i < tried.alternatives.size(); ++i) {
      const Alternative& a = tried.alternatives[i];
      if (!unknown(a.effect) && a.evidence >= least * left &&
          base.cost2 - a.cost2 > (1 - kLeftover) * gain)
        return tried.put_first(i);
    }
  }

  // A formula with more freedom may do the work of two effects, better than either of them alone.
  // So simpler ones that explain nearly as much are tried as the first as well.
  void openings() {
    if (result_.best.effects.empty()) return;
    const Search found = result_;
    const double first_gain = result_.null.cost2 - first_.best().cost2;
    const std::size_t first_amounts = first_.best().effect.amounts.size();
    int count = 0;
    for (std::size_t i = 1; i < first_.alternatives.size() && count < kOpenings; ++i) {
      const Alternative& a = first_.alternatives[i];
      if (unknown(a.effect) || a.effect.amounts.size() >= first_amounts ||
          taken(found.best, a.effect.suspect) ||
          result_.null.cost2 - a.cost2 < kNearly * first_gain)
        continue;
      ++count;
      Search kept = std::move(result_);
      result_ = found;
      result_.best = first_.trials[i];
      result_.members = {{0, found.members[0].gate, {a}}};
      seen_ = {signature()};
      grow(1);
      const double left = std::min(left_by(kept.best), left_by(result_.best));
      Trial other = kept.best;
      if (standing(result_.best, left) > standing(kept.best, left) + kSwap) {
        openings_.push_back(std::move(other));
      } else {
        openings_.push_back(result_.best);
        result_ = std::move(kept);
      }
    }
  }

  // ln of the odds of a hypothesis where the noise is as large as what is left; each effect is
  // charged for as if it had to be taken in.
  static double standing(const Trial& t, double left) {
    double sum = -t.cost2 / 2;
    for (const Accepted& e : t.effects) sum += e.occam;
    return sum / left - kLeastEvidence * static_cast<double>(t.effects.size());
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

  int members() const { return static_cast<int>(result_.best.effects.size()); }

  // Of a rival in a member's place: it must not predict worse.
  bool predicts(const Stage& stage, const Trial& rival, const Trial& member) const {
    return exact_ || !stage.studentised ||
           !(carry_over_->predicted(rival).sum() > carry_over_->predicted(member).sum());
  }

  // Where the noise makes the fit impossible, does the longer hypothesis predict rows better?
  bool carries_over(const Stage& stage, const Trial& longer, const Trial& shorter) const {
    if (exact_ || !stage.studentised) return true;
    return CarryOver::better(carry_over_->predicted(longer), carry_over_->predicted(shorter));
  }

  void progress(const std::string& step, double share) const {
    if (options_.progress) options_.progress(step, share);
  }

  void drop(std::size_t i, Trial rest) {
    result_.best = std::move(rest);
    result_.members.erase(result_.members.begin() + static_cast<long>(i));
  }

  void backward() {
    for (std::size_t i = 0; i < result_.best.effects.size();) {
      Trial rest = fit_trial(ground_, without(result_.best, i), result_.best);
      const double loss = rest.cost2 - result_.best.cost2,
                   freedom = static_cast<double>(result_.best.effects[i].amounts.size());
      if (log_chi2_tail(std::max(0.0, loss / left_by(result_.best)), freedom) > kDropLogP)
        drop(i, std::move(rest));
      else
        ++i;
    }
  }

  void swaps() {
    for (std::size_t i = 0; i < result_.best.effects.size(); ++i) {
      const Trial rest = fit_trial(ground_, without(result_.best, i), result_.best);
      const Stage stage = stage_of(ground_, rest, {options_.suspects});
      Tried tried = finalists_at(stage, rest);
      if (tried.empty()) continue;
      double own = -std::numeric_limits<double>::infinity();
      for (const Alternative& a : tried.alternatives)
        if (same_place(a.effect, result_.best.effects[i].suspect)) own = std::max(own, a.evidence);
      if (!exact_) names_first(tried, rest, kLeastEvidence);
      if (tried.best().evidence > own + kSwap && predicts(stage, tried.trials[0], result_.best)) {
        // In its place among the members, and so among the parameters.
        std::vector<Accepted> effects = tried.trials[0].effects;
        std::rotate(effects.begin() + static_cast<long>(i), effects.end() - 1, effects.end());
        result_.best = fit_trial(ground_, effects, tried.trials[0]);
      }
    }
  }

  // An effect at work at several places is tried at all others of its kind together. What chance
  // would do by itself is dropped again.
  void complete(const Gate& gate) {
    std::map<const Plugin*, int> places;
    for (const Accepted& e : result_.best.effects)
      if (!unknown(e)) ++places[e.suspect.plugin];
    std::erase_if(places, [](const auto& p) { return p.second < 2; });
    for (const auto& [plugin, count] : places) {
      const Stage stage = stage_of(ground_, result_.best, {options_.suspects});
      const std::vector<Score> scores = stage.screen.scores();
      std::map<int, const Score*> best;  // of each suspect
      for (const Score& s : scores) {
        const int of = stage.suspects.ways[s.pick.form].suspect;
        const Suspect& suspect = stage.suspects.suspects[of];
        if (suspect.plugin != plugin || s.freedom == 0 || beside_curve(suspect)) continue;
        if (taken(result_.best, suspect)) continue;
        const Score*& score = best[of];
        if (!score || s.log_bayes > score->log_bayes) score = &s;
      }
      if (best.empty()) continue;
      std::vector<Accepted> effects = result_.best.effects;
      double occam = 0;
      std::vector<Alternative> each;
      for (const auto& [suspect, score] : best) {
        effects.push_back(stage.accepted(ground_, *score));
        occam += effects.back().occam = score->log_bayes - score->all / 2;
        each.push_back({effects.back(), 0, 0, 0});
      }
      Trial all = fit_trial(ground_, effects, result_.best);
      const double gain = result_.best.cost2 - all.cost2;
      if (gain / 2 / left_by(all) + occam < kLeastEvidence ||
          !carries_over(stage, all, result_.best))
        continue;
      result_.best = std::move(all);
      for (Alternative& a : each) result_.members.push_back({0, gate, {std::move(a)}});
      backward();
    }
  }

  // What a curve of the same joint takes up already.
  bool beside_curve(const Suspect& s) const {
    return std::any_of(result_.best.effects.begin(), result_.best.effects.end(),
                       [&](const Accepted& e) {
                         return unknown(e) && !s.joint.empty() && e.suspect.joint == s.joint;
                       });
  }

  // Curves of more pieces in the place of those found, where they predict better.
  void refine() {
    for (std::size_t i = 0; i < result_.best.effects.size(); ++i) {
      std::vector<Accepted> effects = result_.best.effects;
      Accepted& e = effects[i];
      if (!unknown(e)) continue;
      for (const EffectForm& form : e.suspect.plugin->declaration.effect.forms) {
        if (!form.finer || form.amounts.size() <= e.amounts.size()) continue;
        e.way.amounts = form.amounts;
        e.way.typical.resize(form.amounts.size(), e.way.typical[0]);
        e.way.settings["pieces"] = static_cast<double>(form.amounts.size()) - 3;
        e.amounts.assign(form.amounts.size(), 0), e.std = e.amounts;
        Trial finer = fit_trial(ground_, effects, result_.best);
        if (finer.cost2 < result_.best.cost2 &&
            CarryOver::better(carry_over_->predicted(finer), carry_over_->predicted(result_.best)))
          result_.best = std::move(finer);
        break;
      }
    }
  }

  // A named effect whose formula is not quite right leaves something at its place, which a curve
  // takes up. The name stands, the curve is not a finding.
  void leftovers() {
    for (std::size_t i = 0; i < result_.best.effects.size();) {
      const std::vector<Accepted>& effects = result_.best.effects;
      const Accepted& curve = effects[i];
      const bool beside = unknown(curve) && !curve.suspect.joint.empty() &&
                          std::any_of(effects.begin(), effects.end(), [&](const Accepted& e) {
                            return !unknown(e) && e.suspect.joint == curve.suspect.joint;
                          });
      if (beside) {
        Trial rest = fit_trial(ground_, without(result_.best, i), result_.best);
        if (rest.cost2 - result_.best.cost2 < little()) {
          drop(i, std::move(rest));
          continue;
        }
      }
      ++i;
    }
  }

  double little() const { return kLeftover * (result_.null.cost2 - result_.best.cost2); }

  // Of each member, what else could stand in its place.
  void alternatives() {
    const auto& effects = result_.best.effects;
    for (std::size_t i = 0; i < effects.size(); ++i) {
      Member& m = result_.members[i];
      Trial rest = result_.null;
      if (effects.size() > 1 || rounds_ > 1) {
        rest = fit_trial(ground_, without(result_.best, i), result_.best);
        const Stage stage = stage_of(ground_, rest, {options_.suspects});
        m.alternatives = finalists_at(stage, rest).alternatives;
      }
      m.gain = rest.cost2 - result_.best.cost2;
      if (i == 0) beside_others(m.alternatives);
      // A curve that does little more than a name takes up what its formula leaves.
      if (!exact_ && !unknown(effects[i]) && coarse(result_.best))
        std::erase_if(m.alternatives, [&](const Alternative& a) {
          return unknown(a.effect) && a.cost2 > result_.best.cost2 - little();
        });
      probabilities(m.alternatives);
      progress("rivals", (i + 1.0) / static_cast<double>(effects.size()));
    }
  }

  // Other openings: rivals of the first effect that do nearly as well together with further ones.
  void beside_others(std::vector<Alternative>& all) const {
    const auto own = std::find_if(all.begin(), all.end(), [&](const Alternative& a) {
      return same_place(a.effect, result_.best.effects[0].suspect);
    });
    if (own == all.end()) return;
    const double evidence = own->evidence, best = standing(result_.best, result_.left);
    for (const Trial& t : openings_) {
      if (t.effects.empty() || taken(result_.best, t.effects[0].suspect)) continue;
      const double less = std::min(0.0, standing(t, result_.left) - best);
      all.push_back({t.effects[0], evidence + less * result_.left, t.cost2, 0});
    }
    std::stable_sort(all.begin(), all.end(), [](const Alternative& a, const Alternative& b) {
      return a.evidence > b.evidence;
    });
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
  const bool exact_;
  std::optional<CarryOver> carry_over_;
  Tried first_;                  // of the first round
  std::vector<Trial> openings_;  // where others led to
  std::set<std::string> seen_;
  int rounds_ = 0;  // in which an effect was taken in
};

}  // namespace

int discount(const Ground& ground, Search& search, double factor, const SearchOptions& options) {
  const CarryOver carry_over(ground);
  int dropped = 0;
  while (!search.best.effects.empty()) {
    const Eigen::VectorXd whole = carry_over.predicted(search.best);
    std::vector<Trial> rests;
    std::size_t weakest = 0;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < search.best.effects.size(); ++i) {
      rests.push_back(fit_trial(ground, without(search.best, i), search.best));
      const double gain = rests[i].cost2 - search.best.cost2;
      search.members[i].gain = gain;
      double log_p = log_chi2_tail(std::max(0.0, gain * factor / search.left),
                                   static_cast<double>(search.best.effects[i].amounts.size()));
      if (!CarryOver::better(whole, carry_over.predicted(rests[i]))) log_p = 0;
      if (log_p > most) most = log_p, weakest = i;
    }
    if (most + std::log(std::max(1, search.first.tests)) < kChance) break;
    search.best = std::move(rests[weakest]);
    search.members.erase(search.members.begin() + static_cast<long>(weakest));
    ++dropped;
  }
  if (dropped > 0 && !search.best.effects.empty())
    search = Searcher(ground, options, search.exact).weighed_again(std::move(search));
  return dropped;
}

Search search(const Ground& ground, const Trial& null, const SearchOptions& options) {
  Search exact = Searcher(ground, options, true).run(null);
  if (options.most_effects == 1 || exact.best.effects.empty() || exact.left < kCoarse) return exact;
  Search coarse = Searcher(ground, options, false).run(null);
  if (coarse.best.effects.empty()) return exact;  // its place is right more often than its form
  const CarryOver carry_over(ground);
  const double exact_misses = carry_over.predicted(exact.best).sum();
  return exact_misses < carry_over.predicted(coarse.best).sum() ? exact : coarse;
}

}  // namespace talus
