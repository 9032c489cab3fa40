#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/diagnosis/blind_spots.h"
#include "framework/report/diagnosis_report.h"
#include "framework/report/layout.h"

namespace talus {
namespace {

std::string heading(Verdict verdict) {
  std::string text = to_string(verdict);
  for (char& c : text) c = c == '-' ? ' ' : static_cast<char>(std::toupper(c));
  return text;
}

std::string quoted(const std::string& file) {
  return file.find(' ') == std::string::npos ? file : "'" + file + "'";
}

class Writer {
 public:
  Writer(const Diagnosis& d, const Advice& advice, const ReportContext& context,
         const DiagnosisFiles& files, const DiagnosisTextOptions& options)
      : d_(d), advice_(advice), context_(context), files_(files), options_(options) {}

  std::string run() {
    out_ = wrapped(sentence_of(d_), heading(d_.verdict) + ". ", "  ");
    ordinary();
    evidence();
    for (std::size_t i = 0; i < d_.findings.size(); ++i) {
      finding(d_.findings[i], "Finding", curve(advice_.curves, i));
      if (i < advice_.formulas.size() && advice_.formulas[i]) formula(*advice_.formulas[i]);
    }
    for (std::size_t i = 0; i < d_.hints.size(); ++i)
      finding(d_.hints[i],
              d_.findings.empty() ? "Hint, too small to be claimed"
                                  : "Left over at this place, modelled and not claimed",
              curve(advice_.hint_curves, i));
    moved();
    sensitivity();
    next();
    how_to_go_on();
    return std::move(out_);
  }

 private:
  static const Curve* curve(const std::vector<Curve>& all, std::size_t i) {
    return i < all.size() ? &all[i] : nullptr;
  }

  // Faults of the table and blunders.
  void ordinary() {
    if (!d_.faults.empty()) out_ += "\nThe table of recordings\n";
    for (const Fault& f : d_.faults)
      out_ += wrapped(f.statement, f.note ? "  note: " : "  - ", "    ");
    const std::vector<Outlier>& wrong = d_.outliers.found;
    if (wrong.empty()) return;
    out_ += fmt::format("\nPoses that are simply wrong ({}), left out\n", wrong.size());
    for (std::size_t i = 0; i < wrong.size() && (options_.details || i < 5); ++i)
      out_ += wrapped(wrong[i].statement, "  - ", "    ");
    if (!options_.details && wrong.size() > 5)
      out_ += fmt::format("  - and {} more (--details)\n", wrong.size() - 5);
  }

  void evidence() {
    const Fit& b = fit_before(d_);
    out_ += fmt::format("\nEvidence ({} poses fitted, {} held out)\n", b.poses_fit, b.poses_check);
    if (d_.findings.empty()) {
      out_ += wrapped(
          fmt::format("Residuals are {:.3g} sigmas on the poses fitted{}; {:.2g} is what the "
                      "instruments explain.",
                      b.fit_rms,
                      b.poses_check ? fmt::format(", {:.3g} on those held out", b.heldout_rms) : "",
                      b.expected_rms),
          "  ", "  ");
    } else {
      if (const std::string held = sentence_of(d_.heldout, b); !held.empty())
        out_ += wrapped(held, "  ", "  ");
      std::vector<std::string> blocks;
      for (const Block& block : d_.blocks)
        blocks.push_back(fmt::format("{}: {:.3g} to {:.3g} ({} poses)", block.name, block.before,
                                     block.after, block.poses));
      if (!blocks.empty())
        out_ += wrapped("Fitted without, and judged there, sigmas: " + join(blocks, "; ") + ".",
                        "  ", "  ");
      out_ += evidence_table(d_);
    }
    if (!d_.noise.statement.empty()) out_ += wrapped(d_.noise.statement, "  ", "  ");
    if (!b.noise_known)
      out_ += "  The noise is not stated; sigmas are those of what the fit leaves.\n";
  }

  void finding(const Finding& f, const std::string& kind, const Curve* curve) {
    out_ += "\n" + wrapped(sentence_of(f), kind + ". ", "  ");
    out_ += wrapped(
        fmt::format(
            "It moves a typical pose by {:.3g} times its uncertainty; without it chi-square "
            "grows by {:.4g}, which the best of all candidates does by chance with p {} "
            "{:.2g}.",
            f.sigmas, f.delta_chi2, f.p_value < 1e-4 ? "<" : "=", std::max(f.p_value, 1e-4)),
        "  ", "  ");
    if (!options_.details) return;
    for (const NamedRival& r : f.rivals)
      out_ += fmt::format("  rival: {} at {}, probability {:.4f}\n", spoken(r.effect), r.location,
                          r.probability);
    if (curve) out_ += curve_plot(*curve);
  }

  void formula(const Suggestion& s) {
    if (!s.wins) {
      out_ += wrapped(s.statement, "  ", "  ");
    } else {
      out_ += wrapped(s.statement, "  Suggested formula: ", "    ");
      out_ += wrapped(
          fmt::format(
              "{}; residuals of rows held out {:.3g} sigmas with it, {:.3g} with the curve.",
              values_in_words(s.values), s.fit.heldout_rms, d_.after.heldout_rms),
          "    ", "    ");
    }
    if (!options_.details) return;
    for (std::size_t i = 0; i < s.by.size() && i < 6; ++i)
      out_ += fmt::format("  tried: {}, {:.2g} times as likely as the best\n", s.by[i].first,
                          s.by[i].second);
  }

  void moved() {
    if (d_.findings.empty()) return;
    out_ += "\nCalibrated parameters that had taken up some of it\n" +
            moved_parameters(d_, options_.details ? 200 : 5);
  }

  void sensitivity() {
    if (advice_.seen.suspects.empty()) return;
    out_ += "\nWhat would have been seen (in 80 of 100 such recordings)\n";
    const std::string table = sensitivity_table(advice_.seen, options_.sensitivity);
    std::string line;
    for (const char c : table) {
      line += c;
      if (c != '\n') continue;
      out_ += line.starts_with("  not seen")
                  ? wrapped(line.substr(2, line.size() - 3), "  ", "    ")
                  : line;
      line.clear();
    }
    out_ += "\nWhat no analysis of these recordings can see\n";
    int number = 0;
    for (const BlindSpot& b : advice_.seen.blind)
      out_ += wrapped(b.statement, fmt::format("  {}. ", ++number), "     ");
  }

  void next() {
    const NextRecordings& n = advice_.next;
    if (n.statement.empty()) return;
    out_ += "\nWhat to record next\n" + wrapped(n.statement, "  ", "  ");
    if (n.poses.empty()) return;
    std::vector<const NextTarget*> attained;
    for (const NextTarget& t : n.targets)
      if (t.attainable) attained.push_back(&t);
    out_ += next_table(n, d_.program->units, options_.details && attained.size() > 1);
    std::stable_sort(attained.begin(), attained.end(), [](const auto* a, const auto* b) {
      return a->smallest_after * b->smallest_before < b->smallest_after * a->smallest_before;
    });
    for (std::size_t i = 0; i < attained.size() && (options_.details || i < 5); ++i) {
      const NextTarget& t = *attained[i];
      if (t.rivals.empty())
        out_ += wrapped(
            fmt::format("{} at {}: seen from {:.2g} {} on, instead of {} (usual: {:.2g})",
                        spoken(t.effect), t.location, t.smallest_after, t.unit,
                        std::isfinite(t.smallest_before) ? fmt::format("{:.2g}", t.smallest_before)
                                                         : "not at all",
                        t.typical),
            "  - ", "    ");
      else
        out_ += wrapped(fmt::format("{} at {} against {}: what its rival cannot imitate grows from "
                                    "{:.2g} to {:.2g} (chi-square; 12 tells them apart)",
                                    spoken(t.effect), t.location, join(t.rivals, " and "),
                                    t.told_before, t.told_after),
                        "  - ", "    ");
    }
    if (!options_.details && attained.size() > 5)
      out_ += fmt::format("  - and {} more (--details)\n", attained.size() - 5);
    std::string held = next_places(n, *d_.program);
    if (!n.assumed.empty())
      held +=
          " The model states none of " + join(n.assumed) +
          ": what was visited was widened. State range=\"from, to\" to keep poses within reach.";
    out_ += wrapped(held, "  ", "  ");
  }

  void how_to_go_on() {
    out_ += "\nHow to go on\n";
    auto command = [&](const std::string& why, const std::string& line) {
      out_ += fmt::format("  {}\n    talus {}\n", why, line);
    };
    const std::string as_given =
        quoted(context_.model_file) + " " + quoted(context_.recordings_file);
    const std::string model =
        quoted(files_.extended_model.empty() ? context_.model_file : files_.extended_model);
    if (!files_.extended_model.empty()) {
      const std::string extended = model + " " + quoted(context_.recordings_file);
      command("The extended model is in " + files_.extended_model + "; fitted and judged by",
              "calibrate " + extended);
      command("Is anything else missing?", "diagnose " + extended);
    }
    for (const std::string& file : files_.formula_models)
      if (!file.empty())
        command("The formula instead of the curve:",
                "calibrate " + quoted(file) + " " + quoted(context_.recordings_file));
    if (!files_.next_poses.empty())
      command("What these poses should measure:",
              "simulate " + model + " --poses " + quoted(files_.next_poses));
    else if (!advice_.next.poses.empty())
      command("The poses above as a table:", "diagnose " + as_given + " --next next.csv");
    if (!options_.details)
      command("All of the evidence:", "diagnose " + as_given + " --details --sensitivity");
  }

  const Diagnosis& d_;
  const Advice& advice_;
  const ReportContext& context_;
  const DiagnosisFiles& files_;
  const DiagnosisTextOptions& options_;
  std::string out_;
};

}  // namespace

std::string diagnosis_text(const Diagnosis& d, const Advice& advice, const ReportContext& context,
                           const DiagnosisFiles& files, const DiagnosisTextOptions& options) {
  return Writer(d, advice, context, files, options).run();
}

}  // namespace talus
