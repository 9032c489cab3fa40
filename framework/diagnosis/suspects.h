// What could be left out: every registered effect at every place where it can act, in every way it
// can be written (which amounts, which driver, which settings).
//
// An effect is a correction u at a place, a function of its amounts and of the circumstances of the
// pose. Its columns are therefore those of the place's fields (a constant correction there), times
// du/d(amount) at amounts of zero, pose by pose: hundreds of candidates cost little more than one
// evaluation of the model.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "framework/calibration/problem.h"
#include "framework/diagnosis/screen.h"
#include "framework/model/model.h"
#include "framework/registry/registry.h"

namespace talus {

// An effect at a place.
struct Suspect {
  const Plugin* plugin = nullptr;
  std::string effect, location;  // as results name them; effect is "unknown" for a mere curve
  std::string at;                // as the model file says it; empty: the effect's default
  std::vector<int> places;       // of the program with fields
  Dimension dimension;           // of the reading or coordinate that it corrects
  std::string joint;             // to which the place belongs; empty where to none
};

// One way of writing it.
struct Way {
  int suspect = -1;
  std::vector<std::string> amounts;  // those that are free; all others are zero
  std::vector<double> typical;       // of each of them
  std::string driver;
  std::map<std::string, double> settings;  // internal units
  std::vector<int> choices;
  bool onset = false;
};

struct Untestable {
  std::string effect, location, lacks;  // the covariate that was not recorded
};

struct Suspects {
  std::vector<Suspect> suspects;
  std::vector<Way> ways;  // in the order of candidates.forms
  Candidates candidates;  // rows as Problem::linear gives them
  std::vector<Untestable> untestable;
};

// Circumstances of each pose, in the order of Problem::linear: values of all slots.
using PoseSlots = std::vector<std::vector<double>>;

struct SuspectOptions {
  std::vector<std::string> only;  // effects to consider; empty: all
  int threads = 1;
};

// Of a program with fields and its problem made linear where the fields are zero.
Suspects suspects(const Program& program, const Registry& registry, const PoseSlots& slots,
                  const Problem::Linear& linear, const SuspectOptions& options = {});

// The element of a model file that says so, its amounts free with the given values and tolerances.
struct AmountValue {
  double value = 0;
  std::optional<double> tolerance;
};
Element element_of(const Suspect& suspect, const Way& way, const std::vector<AmountValue>& amounts,
                   const UnitSystem& units);

}  // namespace talus
