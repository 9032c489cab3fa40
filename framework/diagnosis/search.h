// Forward and backward: effects are taken into the hypothesis one by one, each the one that the
// recordings speak for most, as long as chance would not make the best of so many candidates as
// good; members that are no longer needed are dropped, and any member is exchanged for a rival that
// does better beside the others.
//
// Where even the best combination leaves far more than the noise, no formula is exact, what is left
// is not noise, and odds that count rows as independent promise too much. The search then begins
// again and goes by other rules: an effect must predict rows that it was not fitted to
// (carry_over.h); a name goes before a curve that explains little more; the number of causes is
// limited, not of places: an effect at work at two places of its kind is tried at all others at
// once (an elastic arm gives way at every joint); simpler openings are tried as well.
#pragma once

#include <cstdint>
#include <functional>

#include "framework/diagnosis/carry_over.h"
#include "framework/diagnosis/finalists.h"

namespace talus {

struct Member {
  double gain = 0;                        // chi-square that is lost without it
  Gate gate;                              // when it was taken in
  std::vector<Alternative> alternatives;  // itself among them, the most probable first
};

struct SearchOptions {
  double alpha_first = 0.01, alpha_later = 0.002;
  int most_effects = 4;
  // Where no combination of so many reaches the noise:
  int most_causes = 6;    // one effect at several places counts once
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
  double left = 1;               // variance that `best` leaves, by the stated noise; at least 1
  bool exact = true;             // by which rules it was found
};

Search search(const Ground& ground, const Trial& null, const SearchOptions& options = {});

// Drops the members that chance makes too easily where noise is correlated from pose to pose, so
// that every chi-square counts for less by this factor; and those that do not predict runs of
// neighbours any better; the rivals of the others are weighed anew. Says how many.
int discount(const Ground& ground, Search& search, double factor, const SearchOptions& options);

}  // namespace talus
