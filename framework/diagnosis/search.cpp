#include "framework/diagnosis/search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/diagnosis/searcher.h"
#include "framework/diagnosis/tails.h"

namespace talus {

constexpr double kCertain =
    30;  // least evidence where no gate was passed, but the fit is impossible
constexpr double kChance = -4.6;  // ln of the chance that is borne with, all candidates counted

bool unknown(const Accepted& e) { return e.suspect.effect == "unknown"; }

std::vector<Accepted> without(const Trial& trial, std::size_t i) {
  std::vector<Accepted> rest = trial.effects;
  rest.erase(rest.begin() + static_cast<long>(i));
  return rest;
}

Searcher::Searcher(const Ground& ground, const SearchOptions& options, bool exact)
    : ground_(ground), options_(options), exact_(exact) {
  if (!exact) carry_over_.emplace(ground);
}

Search Searcher::run(const Trial& null) {
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

Search Searcher::weighed_again(Search found) {
  result_ = std::move(found);
  result_.left = left_by(result_.best);
  rounds_ = 2;
  alternatives();
  return std::move(result_);
}

// Takes effects in, one by one, beside those that the result has.
void Searcher::grow(int first) {
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

Gate Searcher::gate_of(const Stage& stage, int round) const {
  GateOptions options;
  options.alpha = round == 0 ? options_.alpha_first : options_.alpha_later;
  options.seed = options_.seed + static_cast<std::uint64_t>(round);
  options.threads = ground_.threads;
  options.studentised = stage.studentised;
  return stage.screen.gate(options);
}

// The variance that a hypothesis leaves; where it is stated, at least that.
double Searcher::left_by(const Trial& trial) const {
  double dof = result_.stage->dof;
  for (const Accepted& e : trial.effects) dof -= static_cast<double>(e.amounts.size());
  const double left = trial.cost2 / std::max(1.0, dof);
  return ground_.scale.empty() ? std::max(1.0, left) : left;
}

// Of the best, by the noise that it leaves where that is more than stated.
double Searcher::evidence_of(const Tried& tried) const {
  return tried.best().evidence / left_by(tried.trials[0]);
}

Tried Searcher::finalists_at(const Stage& stage, const Trial& base, bool everything) const {
  const int causes = exact_ ? options_.most_effects : options_.most_causes;
  return finalists(ground_, stage, base, {options_.finalists, causes, everything, !exact_});
}

// What is missing may have bent the geometry so far that nothing is seen from there: screening
// from the nominal geometry as well. Its finalists take the others' place where they do better.
void Searcher::unbent(Tried& tried) const {
  Tried others = finalists_at(at_nominal(), result_.best);
  if (!others.empty() && (tried.empty() || others.best().evidence > tried.best().evidence + kSwap))
    tried = std::move(others);
}

// Where the fit is impossible and no promising candidate explains it: each that there is.
Tried Searcher::everything() const {
  progress("trying every candidate", 0);
  return finalists_at(at_nominal(), result_.best, true);
}

// What was accepted, with the geometry as it was before any fit.
Stage Searcher::at_nominal() const {
  Trial nominal;
  nominal.effects = result_.best.effects;
  for (const auto& [name, value] : result_.best.values)
    if (!result_.null.values.contains(name)) nominal.values[name] = value;
  return stage_of(ground_, nominal, {options_.suspects});
}

// Where even the best curve is not exact, a name that leaves it less than it would leave beside
// it (leftovers) goes first.
void Searcher::names_first(Tried& tried, const Trial& base, double least) const {
  if (tried.empty() || !unknown(tried.best().effect) || !coarse(tried.trials[0])) return;
  const double gain = base.cost2 - tried.best().cost2, left = left_by(tried.trials[0]);
  for (std::size_t i = 1; i < tried.alternatives.size(); ++i) {
    const Alternative& a = tried.alternatives[i];
    if (!unknown(a.effect) && a.evidence >= least * left &&
        base.cost2 - a.cost2 > (1 - kLeftover) * gain)
      return tried.put_first(i);
  }
}

// Where the noise makes the fit impossible, does the longer hypothesis predict rows better?
bool Searcher::carries_over(const Stage& stage, const Trial& longer, const Trial& shorter) const {
  if (exact_ || !stage.studentised) return true;
  return CarryOver::better(carry_over_->predicted(longer), carry_over_->predicted(shorter));
}

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
