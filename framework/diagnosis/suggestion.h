// A formula in the place of a curve of unknown physics (formula.h), as an effect of its own: a Lua
// file that can be loaded beside the model, and the model that has it instead of the curve, fitted
// for real. Chosen by the rows to fit; the rows held out are looked at once it is chosen.
#pragma once

#include <optional>

#include "framework/diagnosis/diagnosis.h"
#include "framework/diagnosis/formula.h"

namespace talus {

struct Suggestion {
  FormulaChoice choice;
  bool wins = false;
  std::string statement;                 // what is suggested, or why nothing is
  std::string circumstance, expression;  // "reading of encoder3"; "height * exp(...)"
  std::vector<ShownValue> values;        // amounts and settings, refitted where it wins
  std::vector<std::pair<std::string, double>>
      by;  // names of those tried, by odds against the first
  // Where it wins:
  std::string tag, lua;  // of the effect: its name, its file's text
  Model model;           // the extended model with it instead of the curve; its plugin is not named
  std::shared_ptr<const Program> program;
  Fit fit;
};

// Of member i of the best hypothesis; none where that is no curve of one circumstance.
std::optional<Suggestion> suggest_formula(const Ground& ground, const Diagnosis& diagnosis,
                                          std::size_t i);

// "height * exp(-((r - centre) / width)^2 / 2)", the circumstance being called `x`.
std::string expression_of(const FormulaFit& formula, const std::string& x);
std::string name_of(const FormulaFit& formula);  // "square and Gaussian bump"

}  // namespace talus
