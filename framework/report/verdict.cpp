#include "framework/report/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "framework/kinematics/posture.h"
#include "framework/report/layout.h"

namespace talus {
namespace {

constexpr double kExplained = 1e-3;  // chi-square's p below which the fit warns as well
constexpr double kCarriesOver = 3;   // times worse on rows held out, as the fit warns

std::string poses_text(std::size_t n) { return counted(n, "pose", "poses"); }

// "E.x 0.0051 mm, E.y 0.0048 mm": root mean squares.
std::string errors_text(const std::vector<Measure>& measures, const UnitSystem& units) {
  std::vector<std::string> words;
  for (const Measure& m : measures)
    if (std::isfinite(m.rmse) && words.size() < 9) {
      const Unit unit = units.of(m.dimension);
      words.push_back(fmt::format("{} {:.3g}{}", m.name, m.rmse / unit.factor,
                                  unit.text == "1" ? "" : " " + unit.text));
    }
  return join(words);
}

// Three digits: 1.00, 12.3, 456.
std::string ratio(double v) {
  return v < 100 ? fmt::format("{:#.3g}", v) : fmt::format("{:.0f}", v);
}

std::string directions_text(const Identifiability& seen, const std::string& when) {
  if (seen.unseen.empty())
    return when + (when.empty() ? "Every" : "every") +
           " direction in the space of the free parameters is seen.";
  return fmt::format(
      "{}{} of {} directions in the space of the free parameters are seen; the others keep their "
      "tolerance.",
      when, seen.seen, static_cast<std::size_t>(seen.seen) + seen.unseen.size());
}

void judge(Spoken& verdict, const Fit& fit) {
  auto say = [&](const char* word, const char* headline) {
    verdict.word = word;
    verdict.headline = headline;
  };
  if (!fit.converged)
    say("NOT CONVERGED", "The fit did not converge");
  else if (fit.poses_check > 0 && fit.heldout_rms > kCarriesOver * fit.fit_rms)
    say("NOT EXPLAINED", "Fitted, but the fit does not carry over to the rows held out");
  else if (!(fit.dof > 0))
    say("NOT JUDGED", "Fitted; nothing is left to judge the fit by");
  else if (!fit.noise_known)
    say("CALIBRATED", "Whether what is left is noise cannot be told without stated sigmas");
  else if (fit.chi2_p < kExplained)
    say("NOT EXPLAINED", "Fitted, but more is left than the stated noise explains");
  else
    say("CALIBRATED", "The stated noise explains what the fit leaves");
}

}  // namespace

std::optional<Mood> mood_of(const std::string& word) {
  static constexpr std::pair<const char*, Mood> moods[] = {{"SOUND", Mood::good},
                                                           {"MEASURED", Mood::good},
                                                           {"CALIBRATED", Mood::good},
                                                           {"NOT EXPLAINED", Mood::doubtful},
                                                           {"NOT JUDGED", Mood::doubtful},
                                                           {"NOT CONVERGED", Mood::bad},
                                                           {"LOCATED", Mood::good},
                                                           {"PARTLY LOCATED", Mood::doubtful},
                                                           {"NOT LOCATED", Mood::bad},
                                                           {"NOTHING MISSING", Mood::good},
                                                           {"EXPLAINED", Mood::good},
                                                           {"AMBIGUOUS", Mood::doubtful},
                                                           {"UNKNOWN PHYSICS", Mood::doubtful},
                                                           {"BAD DATA", Mood::bad}};
  for (const auto& [known, mood] : moods)
    if (word == known) return mood;
  return {};
}

std::string noise_in_words(const Fit& fit) {
  if (!(fit.dof > 0)) return "not to be judged";
  return fmt::format("{} {}", ratio(fit.noise_scale),
                     fit.noise_known ? "times the stated noise" : "(weighted; noise not stated)");
}

Spoken verdict_of_model(const Program& program) {
  const Posture posture(program);
  std::set<int> moving;
  for (const JointAxis& axis : posture.axes()) moving.insert(axis.frame);
  return {"SOUND",
          fmt::format("A linkage of {} and {}", counted(moving.size(), "joint", "joints"),
                      counted(program.parameters.size(), "free parameter", "free parameters")),
          {"Every name, unit and frame was found."}};
}

Spoken verdict_of_check(const Program& program, std::size_t poses, std::size_t missing,
                        const Identifiability& seen) {
  Spoken verdict = verdict_of_model(program);
  verdict.sentences.push_back(fmt::format(
      "{} of recordings {} it{}.", poses_text(poses), poses == 1 ? "fits" : "fit",
      missing ? fmt::format("; {} a value", counted(missing, "residual lacks", "residuals lack"))
              : ""));
  verdict.sentences.push_back(directions_text(seen, "At the nominal values "));
  return verdict;
}

Spoken verdict_of_fit(const Program& program, const Fit& fit) {
  Spoken verdict;
  judge(verdict, fit);
  const std::string noise =
      fit.noise_known ? "times the stated noise" : "times the noise that the fit leaves";
  if (fit.poses_check > 0)
    verdict.sentences.push_back(
        fmt::format("On {} held out, residuals are {} {} (root mean square): {}.",
                    poses_text(fit.poses_check), ratio(fit.heldout_rms / fit.expected_rms), noise,
                    errors_text(fit.measures_check, program.units)));
  else
    verdict.sentences.emplace_back("No rows were held out.");
  std::string fitted = fmt::format("On the {} fitted ", poses_text(fit.poses_fit));
  if (fit.dof > 0 && fit.noise_known)
    fitted += fmt::format("they are {}: chi-square {:.5g} on {:.0f} degrees of freedom, {}.",
                          noise_in_words(fit), fit.chi2, fit.dof,
                          fit.chi2_p < 1e-6 ? "p < 1e-6" : fmt::format("p = {:.2g}", fit.chi2_p));
  else
    fitted += fmt::format("they are {} (root mean square).",
                          errors_text(fit.measures_fit, program.units));
  if (fit.poses_check == 0) fitted.replace(fitted.find("they are"), 8, "residuals are");
  verdict.sentences.push_back(fitted);
  verdict.sentences.push_back(directions_text(fit.seen, ""));
  if (verdict.word == "NOT EXPLAINED")
    verdict.sentences.emplace_back("talus diagnose asks what physics the model leaves out.");
  return verdict;
}

Spoken verdict_of_axes(const AxesResult& result, const std::vector<std::string>& names) {
  const std::vector<Located>& all = result.whole.located;
  std::size_t determined = 0, poses = 0;
  bool converged = true;
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const LocatedAxis& a : all[0].axes) determined += a.determined;
  for (const Located& l : all) {
    converged &= l.fit.converged;
    poses += l.fit.poses_fit;
    least = std::min(least, l.fit.noise_scale);
    most = std::max(most, l.fit.noise_scale);
  }
  const std::size_t count = all[0].axes.size();
  Spoken verdict{!converged            ? "NOT CONVERGED"
                 : determined == count ? "LOCATED"
                 : determined == 0     ? "NOT LOCATED"
                                       : "PARTLY LOCATED",
                 fmt::format("{} of {} {} located", determined, counted(count, "axis", "axes"),
                             count == 1 ? "was" : "were"),
                 {}};
  if (all.size() <= 3)
    for (std::size_t r = 0; r < all.size(); ++r)
      verdict.sentences.push_back(fmt::format("{}: {}, residuals {}.", names[r],
                                              poses_text(all[r].fit.poses_fit),
                                              noise_in_words(all[r].fit)));
  else
    verdict.sentences.push_back(fmt::format(
        "{} recordings, {}: residuals {} to {} {}.", all.size(), poses_text(poses), ratio(least),
        ratio(most),
        all[0].fit.noise_known ? "times the stated noise" : "(weighted; noise not stated)"));
  return verdict;
}

std::string text_of(const Spoken& verdict) {
  std::string out = wrapped(verdict.headline + ".", verdict.word + ". ", "  ");
  for (const std::string& sentence : verdict.sentences) out += wrapped(sentence, "  ", "  ");
  return out;
}

}  // namespace talus
