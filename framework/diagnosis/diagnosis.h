// A diagnosis from start to end: where simulation and recordings differ, by what physics, how sure,
// what else it could be, and whether it carries over to rows that took no part.
//
// The ordinary is ruled out first (faults of columns, blunders, noise); then effects are searched
// for on the rows to fit; the rows held out are looked at once, at the end, by the fits with and
// without what was found.
#pragma once

#include <functional>

#include "framework/diagnosis/blocks.h"
#include "framework/diagnosis/claims.h"
#include "framework/diagnosis/evidence.h"
#include "framework/diagnosis/noise.h"
#include "framework/diagnosis/outliers.h"

namespace talus {

enum class Verdict { nothing_missing, explained, ambiguous, unknown_physics, bad_data };
std::string to_string(Verdict verdict);  // as in JSON: "nothing-missing", ...
inline constexpr const char* kWithdrawn =
    "Modelled so, rows held out are predicted worse; the model is left as it was.";

struct Diagnosis {
  Verdict verdict = Verdict::nothing_missing;
  std::string statement;
  std::vector<Finding> findings, hints;  // hints: significant, but too small to be a claim, or
                                         // the leftover of a finding at its place
  Fit baseline, after;  // after is that of the extended model; the baseline where nothing was found
  std::shared_ptr<const Program> program, program_after;
  Model extended_model;  // as it was given, where nothing was found
  std::vector<Fault> faults;
  Outliers outliers;
  std::optional<Fit> clean;  // the baseline without faults and blunders, where there were any
  NoiseVerdict noise;        // of what is left after all
  Recordings recordings;     // as they were judged: faults corrected
  Split split;               // without copies and blunders
  HeldOut heldout;
  bool withdrawn = false;  // modelled so, rows held out were predicted worse: the model is as given
  std::vector<Block> blocks;  // regions and sessions held out, where something was claimed
  Search search;
  std::vector<std::string> warnings;
  double seconds = 0;
};

struct DiagnosisOptions {
  FitOptions fit;
  SearchOptions search;
  std::function<void(const std::string& step, double share)> progress;
};

// The fit of the model as given to the recordings as they were judged.
inline const Fit& fit_before(const Diagnosis& d) { return d.clean ? *d.clean : d.baseline; }

Diagnosis diagnose(const Model& model, const Registry& registry, const Recordings& recordings,
                   const Split& split, const DiagnosisOptions& options = {});

}  // namespace talus
