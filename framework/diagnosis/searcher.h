// The search behind search(): a hypothesis that grows by one effect at a time (search.cpp), is
// amended (search_amend.cpp: other openings, members dropped, exchanged, completed), and at the end
// is asked what else could stand in each member's place (search_rivals.cpp).
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "framework/diagnosis/search.h"

namespace talus {

inline constexpr double kLeastEvidence = 3;  // ln Bayes factor for an effect to be taken in
inline constexpr double kLeftover = 0.15;    // share of all explained: less, by a name, is leftover
inline constexpr double kCoarse = 2.25;      // chi-square per degree of freedom: 1.5 sigmas
inline constexpr double kSwap = 3;           // ln by which a rival must be better

class Searcher {
 public:
  // exact: some combination of formulas may leave nothing but the noise.
  Searcher(const Ground& ground, const SearchOptions& options, bool exact);

  Search run(const Trial& null);

  // What else could stand in the place of each member, anew.
  Search weighed_again(Search found);

 private:
  void grow(int first);
  Gate gate_of(const Stage& stage, int round) const;
  Tried finalists_at(const Stage& stage, const Trial& base, bool everything = false) const;
  void unbent(Tried& tried) const;
  Tried everything() const;
  Stage at_nominal() const;
  void names_first(Tried& tried, const Trial& base, double least) const;
  bool carries_over(const Stage& stage, const Trial& longer, const Trial& shorter) const;

  void openings();
  void backward();
  void swaps();
  void complete(const Gate& gate);
  void refine();
  void leftovers();
  void drop(std::size_t i, Trial rest);
  bool predicts(const Stage& stage, const Trial& rival, const Trial& member) const;
  bool beside_curve(const Suspect& s) const;
  std::string signature() const;

  void alternatives();
  void beside_others(std::vector<Alternative>& all) const;
  void probabilities(std::vector<Alternative>& all) const;
  static double standing(const Trial& t, double left);

  double left_by(const Trial& trial) const;
  double evidence_of(const Tried& tried) const;
  bool convincing(const Tried& tried, double least) const {
    return !tried.empty() && evidence_of(tried) >= least;
  }
  bool coarse(const Trial& trial) const { return left_by(trial) > kCoarse; }
  double little() const { return kLeftover * (result_.null.cost2 - result_.best.cost2); }
  int members() const { return static_cast<int>(result_.best.effects.size()); }
  void progress(const std::string& step, double share) const {
    if (options_.progress) options_.progress(step, share);
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

// Is it a curve of no known cause?
bool unknown(const Accepted& e);
// The hypothesis less its i-th effect.
std::vector<Accepted> without(const Trial& trial, std::size_t i);

}  // namespace talus
