// What these recordings would have shown, in the units of people: of every suspect the smallest
// magnitude that would be seen in 80 of 100 such recordings (sensitivity.h), what it would most
// likely be taken for, and in words what no analysis of these recordings can see:
//     scale      a common factor of measured coordinates is a common factor of all lengths
//     short arc  a joint that turns little shows of a periodic error only what geometry takes up
//     rotor      an error motion that goes round with its joint is a displaced axis
//     constant   what never varied, or was not recorded, has no signature
//     twins      causes with the same columns cannot be told apart by poses like these
#pragma once

#include <string>
#include <vector>

#include "framework/diagnosis/diagnosis.h"
#include "framework/diagnosis/sensitivity.h"

namespace talus {

struct SeenSuspect {
  std::string effect, location;
  std::string amount, unit;           // what the magnitudes are of: "amplitude", "deg"
  double smallest = 0;                // in that unit; infinite where nothing is seen
  double typical = 0;                 // the usual size, in that unit
  double visible = 0;                 // share of the signal that the geometry leaves
  std::string rival, rival_location;  // nearest; empty: none imitates it
  double imitates = 0;
  Sensitivity sensitivity;

  double in_typical() const { return sensitivity.smallest_visible; }
  bool unknown() const { return effect == "unknown"; }
};

struct BlindSpot {
  std::string name, statement;
};

struct Seen {
  std::vector<SeenSuspect> suspects;
  std::vector<Untestable> untestable;
  std::vector<std::vector<int>> twins;  // of `suspects`, no two of which can be told apart
  std::vector<BlindSpot> blind;         // always the five above, in that order
};

// `null` is the linear problem of the model without effects that Search::stage was made from.
Seen seen(const Diagnosis& diagnosis, const Linearised& null, int threads = 1);

}  // namespace talus
