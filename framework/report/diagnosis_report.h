// What a diagnosis is told as: text for people, the verdict first and the evidence behind it; JSON
// for programs (docs/json.md).
#pragma once

#include "framework/diagnosis/advice.h"
#include "framework/report/report.h"

namespace talus {

struct DiagnosisFiles {
  std::string extended_model, next_poses;   // as written; empty: not
  std::vector<std::string> formula_models;  // of each finding; empty: no formula is suggested
};

struct DiagnosisTextOptions {
  bool details = false;      // curves, parameters, all rivals, purposes of all poses
  bool sensitivity = false;  // the whole table of what would have been seen
};

std::string diagnosis_text(const Diagnosis& diagnosis, const Advice& advice,
                           const ReportContext& context, const DiagnosisFiles& files,
                           const DiagnosisTextOptions& options = {});
std::string diagnosis_json(const Diagnosis& diagnosis, const Advice& advice,
                           const ReportContext& context, const DiagnosisFiles& files);

// Sentences (diagnosis_words.cpp).
std::string figure_with_std(double value, double std);  // "0.123 ± 0.004"
std::string values_in_words(const Finding& finding);    // "amplitude 0.123 ± 0.004 deg, order 2"
std::string values_in_words(const std::vector<ShownValue>& values);
std::string sentence_of(const Finding& finding);      // what, where, how large, how sure
std::string sentence_of(const Diagnosis& diagnosis);  // the verdict, in one or two sentences
std::string sentence_of(const HeldOut& heldout, const Fit& baseline);  // empty: none held out

// Tables (diagnosis_tables.cpp).
std::string evidence_table(const Diagnosis& diagnosis);
std::string moved_parameters(const Diagnosis& diagnosis, std::size_t most);
std::string sensitivity_table(const Seen& seen, bool all);
std::string next_table(const NextRecordings& next, const UnitSystem& units, bool purposes);
std::string next_places(const NextRecordings& next, const Program& program);
std::string curve_plot(const Curve& curve);

}  // namespace talus
