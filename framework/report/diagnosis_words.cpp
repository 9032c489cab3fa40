#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/diagnosis/blind_spots.h"
#include "framework/report/diagnosis_report.h"

namespace talus {
namespace {

std::string summary_of(const Finding& f) {
  return f.accepted.suspect.plugin ? f.accepted.suspect.plugin->declaration.summary : "";
}

std::string chance(double p) { return p < 0.001 ? "p < 0.001" : fmt::format("p = {:.2g}", p); }

std::string rivals_in_words(const Finding& f, double least) {
  std::vector<std::string> words;
  for (const NamedRival& r : f.rivals)
    if (r.probability >= least)
      words.push_back(
          fmt::format("{} at {} ({:.2f})", spoken(r.effect), r.location, r.probability));
  return join(words, " or ");
}

std::string what(const Finding& f) {
  return f.effect == "unknown" ? "something unknown at " + f.location
                               : spoken(f.effect) + " at " + f.location;
}

}  // namespace

std::string figure_with_std(double value, double std) {
  if (!std::isfinite(std) || !(std > 0)) return fmt::format("{:.6g}", value);
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(std)));
  if (decimals > 9 || decimals < -6) return fmt::format("{:.4g} ± {:.2g}", value, std);
  const int d = std::max(0, decimals);
  return fmt::format("{:.{}f} ± {:.{}f}", value, d, std, d);
}

std::string values_in_words(const Finding& f) { return values_in_words(f.parameters); }

std::string values_in_words(const std::vector<ShownValue>& values) {
  std::vector<std::string> words;
  for (const ShownValue& v : values)
    words.push_back(fmt::format("{} {}{}", spoken(v.name), figure_with_std(v.value, v.std),
                                v.unit.empty() || v.unit == "1" ? "" : " " + v.unit));
  return join(words, ", ");
}

std::string sentence_of(const Finding& f) {
  std::string text;
  if (f.effect == "unknown") {
    text = fmt::format(
        "At {} something acts that is none of the known effects; a smooth curve describes it",
        f.location);
    const ShownValue *from = nullptr, *to = nullptr;
    for (const ShownValue& v : f.parameters) {
      if (v.name == "from") from = &v;
      if (v.name == "to") to = &v;
    }
    if (from && to)
      text += fmt::format(", learned from {:.4g} to {:.4g}{}, and says nothing beyond", from->value,
                          to->value, to->unit.empty() || to->unit == "1" ? "" : " " + to->unit);
  } else {
    text = fmt::format("At {}: {} ({}), {}", f.location, spoken(f.effect), summary_of(f),
                       values_in_words(f));
  }
  if (!f.driver.empty()) text += ", driven by " + f.driver;
  text += fmt::format(". Probability {:.2f}", f.probability);
  if (const std::string rivals = rivals_in_words(f, 0.01); !rivals.empty())
    text += "; otherwise " + rivals;
  return text + ".";
}

std::string sentence_of(const HeldOut& h, const Fit& baseline) {
  if (h.poses == 0) return "";
  if (h.before == h.after)
    return fmt::format(
        "On {} poses that took no part, residuals are {:.3g} sigmas; {:.2g} is what "
        "the instruments explain.",
        h.poses, h.before, baseline.expected_rms);
  return fmt::format(
      "On {} poses that took no part, residuals fall from {:.3g} to {:.3g} sigmas (95 % interval "
      "{:.3g} to {:.3g}; {:.2g} is what the instruments explain); by chance: {}.",
      h.poses, h.before, h.after, h.after_low, h.after_high, baseline.expected_rms,
      chance(h.p_value));
}

namespace {

// Faults and blunders beside what was found.
std::string beside(const Diagnosis& d) {
  std::string text;
  for (const Fault& f : d.faults)
    if (!f.note) text += " " + f.statement;
  const std::size_t wrong = d.outliers.found.size();
  if (wrong == 1)
    text += " One pose is simply wrong and was left out.";
  else if (wrong > 1)
    text += fmt::format(" {} poses are simply wrong and were left out.", wrong);
  return text;
}

std::string verdict_of(const Diagnosis& d) {
  std::vector<std::string> all;
  for (const Finding& f : d.findings) all.push_back(what(f));
  const std::string names = join(all, " and ");
  const std::string withdrawn = d.withdrawn ? std::string(" ") + kWithdrawn : "";
  switch (d.verdict) {
    case Verdict::nothing_missing:
      if (!d.hints.empty())
        return fmt::format(
            "Nothing is missing that these poses would notice: {} ({:.2f}{}) shows, but moves a "
            "pose by only {:.2g} of its uncertainty. It may matter at other poses.",
            what(d.hints[0]), d.hints[0].probability,
            rivals_in_words(d.hints[0], 0.05).empty() ? ""
                                                      : "; or " + rivals_in_words(d.hints[0], 0.05),
            d.hints[0].sigmas);
      return "Nothing is missing that these recordings could show.";
    case Verdict::explained:
      if (!d.hints.empty())
        return "The model left out " + names +
               ". Its formula does not hold to the last: what it leaves at its place is modelled "
               "as well, and not claimed.";
      if (d.after.noise_known && d.after.chi2_p < 1e-3)
        return fmt::format(
            "The model left out {}; with it, residuals are {:.2g} times the stated noise: a little "
            "more may be missing.",
            names, d.after.noise_scale);
      return "The model left out " + names +
             "; with it, simulation and recordings agree as closely as the instruments can tell.";
    case Verdict::ambiguous: {
      std::vector<std::string> words;
      for (const Finding& f : d.findings) {
        const std::string rivals = rivals_in_words(f, 0.05);
        words.push_back(fmt::format("{} ({:.2f}){}", what(f), f.probability,
                                    rivals.empty() ? "" : " or " + rivals));
      }
      if (words.empty()) return d.statement;
      return "Something is missing, and these recordings do not settle what: " +
             join(words, "; and ") + "." + withdrawn;
    }
    case Verdict::unknown_physics: {
      std::vector<std::string> places;
      for (const Finding& f : d.findings)
        if (std::find(places.begin(), places.end(), f.location) == places.end())
          places.push_back(f.location);
      return "Physics that is none of the known effects acts at " + join(places, " and ") +
             ": its shape is given, not its cause." + withdrawn;
    }
    case Verdict::bad_data:
      return d.statement;
  }
  return d.statement;
}

}  // namespace

std::string sentence_of(const Diagnosis& d) {
  return verdict_of(d) + (d.verdict == Verdict::bad_data ? "" : beside(d));
}

}  // namespace talus
