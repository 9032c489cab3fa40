#include "framework/diagnosis/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/diagnosis/tails.h"

namespace talus {
namespace {

constexpr double kSure = 0.8;  // a name is claimed from this probability on
// A misfit that cannot be chance nor a small error of the stated noise.
constexpr double kImpossible = 1e-6, kPlain = 1.5;
// Where the whole does not hold to the noise, less than this share of it is what a formula leaves.
constexpr double kPile = 0.15;
constexpr double kFurther = 0.01;  // chance of rows held out as far off
constexpr double kClean = 1e-3;    // chance of a misfit that leaves nothing to explain

// A fit that the noise makes impossible, and rows held out that lie further off yet than those
// fitted: the form is not right.
bool short_of(const Diagnosis& d) {
  const Fit& fit = d.after;
  const double rows = static_cast<double>(fit.residuals_check.whitened.size());
  if (!fit.noise_known || fit.chi2_p > kImpossible || !(rows > 0)) return false;
  const double ratio = std::pow(fit.heldout_rms / fit.noise_scale, 2);
  return log_f_tail(ratio, rows, fit.dof) < std::log(kFurther);
}

}  // namespace

std::string to_string(Verdict verdict) {
  static constexpr const char* names[] = {"nothing-missing", "explained", "ambiguous",
                                          "unknown-physics", "bad-data"};
  return names[static_cast<int>(verdict)];
}

void conclude(Diagnosis& d) {
  const bool faulty =
      !d.outliers.found.empty() ||
      std::any_of(d.faults.begin(), d.faults.end(), [](const Fault& f) { return !f.note; });
  std::vector<std::string> words;
  for (const Fault& f : d.faults)
    if (!f.note) words.push_back(f.statement);
  if (!d.outliers.found.empty()) words.push_back(d.outliers.statement);
  const bool misfit =
      d.after.noise_known && d.after.chi2_p < kImpossible && d.after.noise_scale > kPlain;
  if (d.findings.empty()) {
    d.verdict = faulty ? Verdict::bad_data : Verdict::nothing_missing;
    d.statement = faulty ? join(words, " ") + " Nothing else is seen."
                         : "Nothing is missing that these recordings could show.";
    if (!faulty && misfit) {
      d.verdict = Verdict::ambiguous;
      d.statement = fmt::format(
          "Something is missing: residuals are {:.3g} sigmas. No candidate explains it. {}",
          d.after.fit_rms, d.noise.statement);
    }
    return;
  }
  // Names that stack up in one place are the shape of something third, unless each does another
  // thing there and nothing is left to explain.
  const bool clean = (!d.after.noise_known || d.after.chi2_p > kClean) && d.noise.unwhite.empty();
  const double gain = d.search.null.cost2 - d.search.best.cost2;
  bool unknown = false, sure = !short_of(d);
  std::vector<std::string> found;
  for (Finding& f : d.findings) {
    unknown |= f.effect == "unknown";
    sure &= f.probability >= kSure;
    for (const Finding& other : d.findings)
      unknown |= &f != &other && one_place(f.accepted, other.accepted) &&
                 (!clean || one_kind(f.accepted, other.accepted)) &&
                 (!misfit || std::min(f.delta_chi2, other.delta_chi2) >= kPile * gain);
    f.statement = fmt::format("{} at {} (probability {:.2f})", f.effect, f.location, f.probability);
    found.push_back(f.statement);
  }
  d.verdict = unknown || d.withdrawn ? Verdict::unknown_physics
              : sure                 ? Verdict::explained
                                     : Verdict::ambiguous;
  d.statement =
      join(found, " and ") + fmt::format("; rows held out: {:.3g} sigmas instead of {:.3g}.",
                                         d.after.heldout_rms, fit_before(d).heldout_rms);
  if (d.withdrawn) d.statement = join(found, " and ") + ". " + kWithdrawn;
  for (const std::string& word : words) d.statement += ' ' + word;
}

}  // namespace talus
