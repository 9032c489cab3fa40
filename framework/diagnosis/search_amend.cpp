// What amends a hypothesis while it grows and after.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "framework/diagnosis/searcher.h"
#include "framework/diagnosis/tails.h"

namespace talus {

constexpr double kNearly = 0.85;  // of the gain of the first: explains nearly as much
constexpr int kOpenings = 2;
constexpr double kDropLogP = -6.9;  // a member whose loss costs less than this is dropped

// A formula with more freedom may do the work of two effects, better than either of them alone.
// So simpler ones that explain nearly as much are tried as the first as well.
void Searcher::openings() {
  if (result_.best.effects.empty()) return;
  const Search found = result_;
  const double first_gain = result_.null.cost2 - first_.best().cost2;
  const std::size_t first_amounts = first_.best().effect.amounts.size();
  int count = 0;
  for (std::size_t i = 1; i < first_.alternatives.size() && count < kOpenings; ++i) {
    const Alternative& a = first_.alternatives[i];
    if (unknown(a.effect) || a.effect.amounts.size() >= first_amounts ||
        taken(found.best, a.effect.suspect) || result_.null.cost2 - a.cost2 < kNearly * first_gain)
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

// Which effects, where and how.
std::string Searcher::signature() const {
  std::vector<std::string> parts;
  for (const Accepted& e : result_.best.effects) {
    parts.push_back(e.suspect.effect + "@" + e.suspect.at + ":" + e.way.driver);
    for (const auto& [name, value] : e.way.settings)
      parts.back() += fmt::format(",{}={}", name, value);
  }
  std::sort(parts.begin(), parts.end());
  return join(parts);
}

void Searcher::drop(std::size_t i, Trial rest) {
  result_.best = std::move(rest);
  result_.members.erase(result_.members.begin() + static_cast<long>(i));
}

void Searcher::backward() {
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

void Searcher::swaps() {
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
void Searcher::complete(const Gate& gate) {
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
    if (gain / 2 / left_by(all) + occam < kLeastEvidence || !carries_over(stage, all, result_.best))
      continue;
    result_.best = std::move(all);
    for (Alternative& a : each) result_.members.push_back({0, gate, {std::move(a)}});
    backward();
  }
}

// What a curve of the same joint takes up already.
bool Searcher::beside_curve(const Suspect& s) const {
  return std::any_of(result_.best.effects.begin(), result_.best.effects.end(),
                     [&](const Accepted& e) {
                       return unknown(e) && !s.joint.empty() && e.suspect.joint == s.joint;
                     });
}

// Curves of more pieces in the place of those found, where they predict better.
void Searcher::refine() {
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
void Searcher::leftovers() {
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

// Of a rival in a member's place: it must not predict worse.
bool Searcher::predicts(const Stage& stage, const Trial& rival, const Trial& member) const {
  return exact_ || !stage.studentised ||
         !(carry_over_->predicted(rival).sum() > carry_over_->predicted(member).sum());
}

}  // namespace talus
