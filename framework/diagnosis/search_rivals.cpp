// What else could stand in the place of each effect that was found.
#include <algorithm>
#include <cmath>

#include "framework/diagnosis/searcher.h"

namespace talus {

// Of each member, what else could stand in its place.
void Searcher::alternatives() {
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
void Searcher::beside_others(std::vector<Alternative>& all) const {
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

// ln of the odds of a hypothesis where the noise is as large as what is left; each effect is
// charged for as if it had to be taken in.
double Searcher::standing(const Trial& t, double left) {
  double sum = -t.cost2 / 2;
  for (const Accepted& e : t.effects) sum += e.occam;
  return sum / left - kLeastEvidence * static_cast<double>(t.effects.size());
}

void Searcher::probabilities(std::vector<Alternative>& all) const {
  if (all.empty()) return;
  // One entry per suspect: its best way.
  std::vector<Alternative> merged;
  for (Alternative& a : all)
    if (std::none_of(merged.begin(), merged.end(),
                     [&](const Alternative& m) { return same_place(m.effect, a.effect.suspect); }))
      merged.push_back(a);
  all = std::move(merged);
  // Where even the best leaves more than the noise, differences count for less.
  double sum = 0;
  for (Alternative& a : all)
    sum += a.probability = std::exp((a.evidence - all[0].evidence) / result_.left);
  for (Alternative& a : all) a.probability /= sum;
}

}  // namespace talus
