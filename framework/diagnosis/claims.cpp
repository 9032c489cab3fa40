#include "framework/diagnosis/claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

// Below so many sigmas of a pose, what was found is a hint: nobody would notice it in one
// recording.
constexpr double kNoticeable = 1;
constexpr double kByCatch = 0.15;     // share of all explained, beside what wanders with the time
constexpr double kCorrelated = 1e-6;  // chance of neighbours in time as much alike
// A formula that is right within a fifth leaves up to a twenty-fifth of its chi-square. What is no
// more than that, beside a finding of the same joint, may be its leftover and is not named.
constexpr double kRemainder = 0.04;
// Above this chi-square per degree of freedom something that is not modelled is left over.
constexpr double kFar = 2.25;
constexpr double kTrust = 0.2;  // trusted less, what was found beside something else is a hint

// How sure a name can be beside that: a cause that explains less than what is left over may be
// its shadow.
double trust(const Search& search, const Member& m) {
  if (search.left <= kFar) return 1;
  const double over = search.best.cost2 * (1 - 1 / search.left);
  return m.gain / (m.gain + over);
}

Finding finding(const Accepted& e, const Member& m, double poses, double rows,
                const UnitSystem& units) {
  Finding f;
  f.accepted = e;
  f.effect = e.suspect.effect, f.location = e.suspect.location;
  f.driver = e.way.driver;
  f.parameters = shown_values(e, units);
  f.delta_chi2 = m.gain;
  f.delta_bic = m.gain - static_cast<double>(e.amounts.size()) * std::log(std::max(2.0, rows));
  f.p_value = m.gate.family_p;
  f.sigmas = std::sqrt(std::max(0.0, m.gain) / poses);
  for (const Alternative& a : m.alternatives) {
    const Suspect& s = a.effect.suspect;
    if (s.plugin == e.suspect.plugin && s.at == e.suspect.at)
      f.probability = a.probability;
    else if (a.probability > 1e-4)
      f.rivals.push_back({s.effect, s.location, a.probability});
  }
  return f;
}

bool remainder(const Finding& f, const std::vector<Finding>& all) {
  return std::any_of(all.begin(), all.end(), [&](const Finding& other) {
    return &f != &other && other.effect != "unknown" && one_place(f.accepted, other.accepted) &&
           !one_kind(f.accepted, other.accepted) && f.delta_chi2 < kRemainder * other.delta_chi2;
  });
}

// Of several things that wander with the time, each by itself and some in no known way: how many.
// That is noise which is not independent; what little is beside them is its by-catch.
int drifting(const Search& found) {
  int wandering = 0;
  bool curve = false;
  double others = 0;
  for (std::size_t i = 0; i < found.best.effects.size(); ++i) {
    const EffectTraits& effect = found.best.effects[i].suspect.plugin->declaration.effect;
    if (effect.needs.empty() ||
        !std::all_of(effect.needs.begin(), effect.needs.end(), [](Covariate c) {
          return c == Covariate::time || c == Covariate::pose || c == Covariate::since;
        })) {
      others += found.members[i].gain;
      continue;
    }
    ++wandering;
    curve |= effect.unknown;
  }
  const bool noise =
      wandering >= (curve ? 2 : 3) && others <= kByCatch * (found.null.cost2 - found.best.cost2);
  return noise ? wandering : 0;
}

}  // namespace

bool one_place(const Accepted& a, const Accepted& b) {
  return !a.suspect.joint.empty() && a.suspect.joint == b.suspect.joint;
}

bool one_kind(const Accepted& a, const Accepted& b) {
  const EffectTraits &one = a.suspect.plugin->declaration.effect,
                     &other = b.suspect.plugin->declaration.effect;
  // An error of a reading and one of its joint's coordinate are the same to the linkage.
  auto channel = [](const EffectTraits& e) {
    return e.acts == Acts::reading ? Acts::coordinate : e.acts;
  };
  return channel(one) == channel(other) && one.needs == other.needs;
}

std::vector<Fault> without_correlated(const Ground& ground, const NoiseVerdict& noise,
                                      Search& search, const SearchOptions& options) {
  if (noise.p_order > kCorrelated || noise.correlation <= 0) return {};
  const double factor = (1 - noise.correlation) / (1 + noise.correlation);
  const int dropped = discount(ground, search, factor, options);
  if (dropped == 0) return {};
  return {
      {"correlated-noise", "measurement",
       fmt::format("The noise is not independent from pose to pose (correlation of neighbours "
                   "{:.2f}); by that measure {} not beyond chance.",
                   noise.correlation,
                   dropped == 1 ? "one drift or step that follows it is"
                                : fmt::format("{} drifts and steps that follow it are", dropped))}};
}

Claims claims_of(const Search& search, std::size_t poses, std::size_t rows,
                 const UnitSystem& units) {
  Claims claims;
  const auto& effects = search.best.effects;
  if (effects.empty()) return claims;
  const double count = static_cast<double>(std::max<std::size_t>(1, poses));
  const double gain = std::max(0.0, search.null.cost2 - search.best.cost2);
  const int wandering = drifting(search);
  const bool claimed = std::sqrt(gain / search.left / count) > kNoticeable && wandering == 0;
  if (wandering > 0)
    claims.faults.push_back(
        {"correlated-noise", "measurement",
         fmt::format("The noise is not independent from pose to pose: it takes {} separate drifts "
                     "and steps to follow it.",
                     wandering)});
  std::vector<Finding> all;
  std::vector<double> trusts;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    all.push_back(finding(effects[i], search.members[i], count, static_cast<double>(rows), units));
    trusts.push_back(trust(search, search.members[i]));
    all.back().probability *= trusts[i];
    for (NamedRival& r : all.back().rivals) r.probability *= trusts[i];
  }
  const double least = std::min(kTrust, *std::max_element(trusts.begin(), trusts.end()));
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool finding = claimed && !remainder(all[i], all) && trusts[i] >= least;
    (finding ? claims.findings : claims.hints).push_back(all[i]);
  }
  return claims;
}

}  // namespace talus
