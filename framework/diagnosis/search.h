// Forward and backward: effects are taken into the hypothesis one by one, each the one that the
// recordings speak for most, as long as chance would not make the best of so many candidates as
// good; members that are no longer needed are dropped, and any member is exchanged for a rival that
// does better beside the others.
//
// The number of causes is limited, not of places: where an effect is at work at two places of its
// kind, it is tried at all others at once (an elastic arm gives way at every joint), and what is
// not needed of these is dropped again.
#pragma once

#include <cstdint>
#include <functional>

#include "framework/diagnosis/carry_over.h"
#include "framework/diagnosis/stage.h"

namespace talus {

// A hypothesis on one effect's place in the final set: how much the recordings speak for it.
struct Alternative {
  Accepted effect;
  double evidence = 0;     // ln of the Bayes factor against nothing in its place
  double cost2 = 0;        // of the refit; NaN where only screened
  double probability = 0;  // among the alternatives
};

struct Member {
  double gain = 0;                        // chi-square that is lost without it
  Gate gate;                              // when it was taken in
  std::vector<Alternative> alternatives;  // itself among them, the most probable first
};

struct SearchOptions {
  double alpha_first = 0.01, alpha_later = 0.002;
  int most_effects = 6;   // causes: one effect at several places counts once
  int most_members = 24;  // places in all
  int finalists = 8;
  std::uint64_t seed = 1;
  SuspectOptions suspects;
  std::function<void(const std::string& step, double share)> progress;
};

struct Search {
  Trial null, best;              // without effects, and with those found
  std::vector<Member> members;   // as best.effects
  Gate first;                    // of the first round
  std::shared_ptr<Stage> stage;  // of `null`: what could be seen at all
  std::shared_ptr<Stage> last;   // of `best`
};

Search search(const Ground& ground, const Trial& null, const SearchOptions& options = {});

}  // namespace talus
