// The candidates that look most promising beside a hypothesis, fitted for real.
//
// Screening ranks all forms of all suspects. Those that lead go on, what no recordings of these
// poses tell apart as one; and what else can act at the places of the first, since screening goes
// by a geometry that the missing effect has bent. Each is refitted from the fitted and from the
// nominal geometry. Settings that are readings (where something sets in) are then made better than
// the few that were screened.
#pragma once

#include "framework/diagnosis/stage.h"

namespace talus {

// A hypothesis on one effect's place in the final set: how much the recordings speak for it.
struct Alternative {
  Accepted effect;
  double evidence = 0;     // ln of the Bayes factor against nothing in its place
  double cost2 = 0;        // of the refit
  double probability = 0;  // among the alternatives
};

// Candidates and their fits, the one with the most evidence first.
struct Tried {
  std::vector<Alternative> alternatives;
  std::vector<Trial> trials;

  bool empty() const { return alternatives.empty(); }
  const Alternative& best() const { return alternatives.front(); }
  void drop(std::size_t i);
  void put_first(std::size_t i);
};

struct FinalistOptions {
  int leading = 8;
  int most_causes = 6;      // of a hypothesis: one effect at several places counts once
  bool everything = false;  // some forms of each suspect, however they look
  bool stiff = false;       // curves only as free as what is left over asks for
};

Tried finalists(const Ground& ground, const Stage& stage, const Trial& base,
                const FinalistOptions& options);

// One plugin at one place.
bool same_place(const Accepted& a, const Suspect& s);
bool taken(const Trial& trial, const Suspect& s);

}  // namespace talus
