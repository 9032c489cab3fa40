// A formula for a curve of unknown physics: sparse regression over a library of elementary
// functions (formula_shapes.h), one or two at a time.
//
// All is judged modulo what the geometry can take up (curve_evidence.h): a formula costs a product,
// not a fit. Settings are scanned over their range and polished.
// Formulas are weighed against each other, and against the free curve, by
//     BIC = chi-square / noise + (amounts + settings) ln(rows),
// a choice among n variants costing 2 ln n more; odds are exp(difference / 2). A formula is
// suggested only if no different one comes within odds of 20, if it is not worse than the free
// curve, and if a free curve beside it finds nothing more.
#pragma once

#include "framework/diagnosis/curve_evidence.h"
#include "framework/diagnosis/formula_shapes.h"

namespace talus {

struct FormulaTerm {
  const Shape* shape = nullptr;
  std::vector<double> settings;  // as Shape::settings
};

struct FormulaFit {
  std::vector<FormulaTerm> terms;
  Eigen::VectorXd amounts;  // of the terms one after the other
  Eigen::VectorXd signal;   // the correction at the poses
  double chi2 = 0, bic = 0;
  int parameters = 0;
  bool edge = false;  // a setting is at the end of its range: it imitates something else
};

struct FormulaChoice {
  enum class Outcome {
    wins,
    rivals,  // another formula does about as well
    misfit,  // even the best leaves something that a free curve finds
    curve,   // the free curve is better
    nothing  // no formula can be tried
  } outcome = Outcome::nothing;
  std::vector<FormulaFit> ranked;  // by BIC; the chosen one first, then those that differ from it
  double odds = 0;                 // over the next that differs
  double beside_p = 1;             // of what a free curve finds beside it, by chance
  double curve_chi2 = 0, curve_bic = 0;
  int curve_parameters = 0;
  double noise = 1;  // variance that all chi-squares were divided by
};

FormulaChoice choose_formula(const CurveEvidence& evidence);

inline constexpr double kFormulaOdds = 20;      // to be called a clear winner
inline constexpr double kFormulaBeside = 0.01;  // below: a free curve finds more

}  // namespace talus
