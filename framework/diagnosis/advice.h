// What a diagnosis is followed by: what could have been seen (seen.h), what each finding corrects
// (curve.h), a formula for what is unknown (suggestion.h), and which poses to record next. These
// are chosen to tell the findings from their rivals where the verdict is ambiguous, and otherwise
// to show the usual suspects that the recordings at hand would not show.
#pragma once

#include <cmath>

#include "framework/diagnosis/curve.h"
#include "framework/diagnosis/seen.h"
#include "framework/diagnosis/suggestion.h"

namespace talus {

struct NextTarget {
  std::string effect, location, amount, unit;
  double smallest_before = 0, smallest_after = 0;  // magnitude that would be seen, in that unit
  double typical = 0;
  std::vector<std::string> rivals;         // to be told from: "effect at location"
  double told_before = 0, told_after = 0;  // chi-square that the nearest leaves; 12 is needed
  bool attainable = true;                  // by any of the poses that were tried
};

struct NextPose {
  std::size_t row = 0;                // of the table
  std::vector<double> coordinates;    // as NextRecordings::names, internal units
  std::vector<std::string> purposes;  // "see encoder eccentricity at encoder3", the first the most
  std::string how;                    // "joint3 from above, with 2 kg"; empty: only go there
  double again = std::nan("");        // number of the recorded pose that it repeats
  double gain = 0;  // share of the chi-square of its first purpose that would be lost without it
};

struct NextRecordings {
  std::vector<std::string> names;  // of the coordinates: sensors, then unknowns of a pose
  std::vector<Dimension> dimensions;
  std::vector<bool> moves;           // false for unknowns of a group: as they were
  std::vector<std::string> assumed;  // those whose range the model does not state
  std::vector<NextPose> poses;       // the most useful first
  Recordings table;                  // readings and circumstances, one row per pose
  std::string mounting;              // "B turned 90 deg about its x axis", where some need it
  std::vector<std::string> loops;    // closures that the poses keep
  double before = 0, after = 0;      // least of chi-square over what is needed, attainable targets
  std::vector<NextTarget> targets;
  std::string statement;  // what they are for, or why there are none
};

struct Advice {
  Seen seen;
  std::vector<Curve> curves, hint_curves;           // of Diagnosis::findings, hints
  std::vector<std::optional<Suggestion>> formulas;  // of Diagnosis::findings: those of curves
  NextRecordings next;
};

struct AdviceOptions {
  SuspectOptions suspects;
  int threads = 1;
  std::uint64_t seed = 1;
  int pool = 300, poses = 8;  // no next poses where one is 0
  std::function<void(const std::string& step, double share)> progress;
};

// `model` is the one that was diagnosed.
Advice advise(const Model& model, const Registry& registry, const Diagnosis& diagnosis,
              const AdviceOptions& options = {});

NextRecordings next_recordings(const Ground& ground, const Diagnosis& diagnosis, const Seen& seen,
                               const AdviceOptions& options);

}  // namespace talus
