#include "framework/diagnosis/blunders.h"

#include <set>

namespace talus {
namespace {

constexpr int kNear = 5;  // poses

// Where else an effect may set in, by the blunders next to where it does: before them or after.
std::set<int> other_onsets(int onset, const Outliers& outliers) {
  std::set<int> others;
  int first = onset, last = onset - 1;
  for (const Outlier& o : outliers.found) {
    if (o.pose < onset && o.pose >= onset - kNear) first = std::min(first, o.pose);
    if (o.pose >= onset && o.pose < onset + kNear) last = std::max(last, o.pose);
  }
  if (first < onset) others.insert(first);
  if (last >= onset) others.insert(last + 1);
  return others;
}

}  // namespace

Outliers blunders_beside(const Ground& ground, const Trial& trial, const Split& whole,
                         const OutlierOptions& options) {
  auto found = [&](const Trial& t) {
    return find_outliers(*t.program, *ground.recordings, whole, t.x, options);
  };
  Outliers best = found(trial);
  for (std::size_t i = 0; i < trial.effects.size(); ++i) {
    const EffectTraits& effect = trial.effects[i].suspect.plugin->declaration.effect;
    if (effect.onset.empty() || effect.onset_of == Covariate::session) continue;
    const int onset = static_cast<int>(trial.effects[i].way.settings.at(effect.onset));
    for (const int other : other_onsets(onset, best)) {
      std::vector<Accepted> effects = trial.effects;
      effects[i].way.settings[effect.onset] = other;
      Outliers moved = found(fit_trial(ground, effects, trial));
      if (moved.found.size() < best.found.size()) best = std::move(moved);
    }
  }
  return best;
}

}  // namespace talus
