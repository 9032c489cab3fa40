#include "framework/diagnosis/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "framework/diagnosis/tails.h"

namespace talus {
namespace {

// Below so many sigmas of a pose, what was found is a hint: nobody would notice it in one
// recording.
constexpr double kNoticeable = 1;
constexpr double kSure = 0.8;        // a name is claimed from this probability on
constexpr double kLastNamed = 0.05;  // rivals below it are not listed as possible

Eigen::VectorXd squares(const Problem::Residuals& r) {
  return r.whitened.size() > 0 ? Eigen::VectorXd(r.whitened.rowwise().squaredNorm())
                               : Eigen::VectorXd(0);
}

// "joint3" and "encoder3" are one place where the sensor is the joint's.
std::string channel(const Accepted& e) { return e.suspect.location; }

Fit fit_of(const Program& program, const Recordings& recordings, const Split& split,
           FitOptions options) {
  return calibrate(program, recordings, split, options);
}

}  // namespace

std::string to_string(Verdict verdict) {
  static constexpr const char* names[] = {"nothing-missing", "explained", "ambiguous",
                                          "unknown-physics", "bad-data"};
  return names[static_cast<int>(verdict)];
}

Diagnosis diagnose(const Model& model, const Registry& registry, const Recordings& recordings,
                   const Split& split, const DiagnosisOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Diagnosis d;
  auto progress = [&](const std::string& step, double share) {
    if (options.progress) options.progress(step, share);
  };
  progress("calibrating", 0);
  auto program = std::make_shared<Program>(compile(model, registry));
  d.program = program;
  d.baseline = fit_of(*program, recordings, split, options.fit);
  d.extended_model = model;

  const Recordings known = with_circumstances(model, registry, *program, recordings, d.baseline.x);
  Ground ground{&model, &registry, &known, split.fit, options.fit.threads};
  const Trial null = trial_of(ground, d.baseline);
  SearchOptions search_options = options.search;
  search_options.progress = options.progress;
  d.search = search(ground, null, search_options);
  const Search& found = d.search;

  // What was found, before any row held out was looked at.
  const double poses = static_cast<double>(std::max<std::size_t>(1, split.fit.size()));
  const double gain = null.cost2 - found.best.cost2;
  const bool claimed =
      !found.best.effects.empty() && std::sqrt(std::max(0.0, gain) / poses) > kNoticeable;
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < found.best.effects.size(); ++i) {
    const Accepted& e = found.best.effects[i];
    const Member& m = found.members[i];
    Finding f;
    f.accepted = e;
    f.effect = e.suspect.effect, f.location = e.suspect.location;
    f.driver = e.way.driver;
    f.parameters = shown_values(e, program->units);
    f.delta_chi2 = m.gain;
    f.delta_bic =
        m.gain - static_cast<double>(e.amounts.size()) *
                     std::log(std::max<double>(2, static_cast<double>(d.baseline.rows_fit)));
    f.p_value = m.gate.family_p;
    f.sigmas = std::sqrt(std::max(0.0, m.gain) / poses);
    for (const Alternative& a : m.alternatives) {
      const Suspect& s = a.effect.suspect;
      if (s.plugin == e.suspect.plugin && s.at == e.suspect.at)
        f.probability = a.probability;
      else if (a.probability > 1e-4)
        f.rivals.push_back({s.effect, s.location, a.probability});
    }
    findings.push_back(std::move(f));
  }
  if (claimed)
    d.findings = std::move(findings);
  else
    d.hints = std::move(findings);

  progress("judging", 0.9);
  d.after = d.baseline;
  d.program_after = program;
  if (!found.best.effects.empty() && claimed) {
    const Model whole = extended(model, found.best.effects, program->units);
    auto after = std::make_shared<Program>(compile(whole, registry));
    FitOptions fit_options = options.fit;
    fit_options.restarts = 0;
    for (const Parameter& p : after->parameters)
      fit_options.start.push_back(found.best.values.at(p.name));
    for (const FittedValue& v : d.baseline.shared)
      fit_options.start.push_back(found.best.values.at(v.name));
    d.after = fit_of(*after, known, split, fit_options);
    d.extended_model = whole;
    d.program_after = std::move(after);
  }
  const Eigen::VectorXd before = squares(d.baseline.residuals_check),
                        after = squares(d.after.residuals_check);
  if (before.size() == after.size() && before.size() > 0) {
    const double rows =
        before.sum() / std::pow(d.baseline.heldout_rms, 2) / static_cast<double>(before.size());
    d.heldout = held_out(before, after, rows, options.fit.seed);
  }
  for (Finding& f : d.findings) {
    f.heldout_before = d.baseline.heldout_rms;
    f.heldout_after = d.after.heldout_rms;
  }

  // The verdict.
  const bool misfit =
      d.baseline.noise_known && d.baseline.chi2_p < 1e-4 && d.baseline.noise_scale > 1.1;
  if (d.findings.empty()) {
    d.verdict = misfit ? Verdict::bad_data : Verdict::nothing_missing;
    d.statement =
        misfit ? fmt::format("Noise is {:.2g} times larger than stated, and nothing else is seen.",
                             d.baseline.noise_scale)
               : "Nothing is missing that these recordings could show.";
  } else {
    bool unknown = false, sure = true;
    for (const Finding& f : d.findings) {
      unknown |= f.effect == "unknown";
      sure &= f.probability >= kSure;
      for (const Finding& other : d.findings)
        unknown |= &f != &other && channel(f.accepted) == channel(other.accepted);
    }
    d.verdict = unknown ? Verdict::unknown_physics : sure ? Verdict::explained : Verdict::ambiguous;
    std::vector<std::string> words;
    for (Finding& f : d.findings) {
      f.statement =
          fmt::format("{} at {} (probability {:.2f})", f.effect, f.location, f.probability);
      words.push_back(f.statement);
    }
    d.statement =
        join(words, " and ") + fmt::format("; rows held out: {:.3g} sigmas instead of {:.3g}.",
                                           d.after.heldout_rms, d.baseline.heldout_rms);
  }
  d.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return d;
}

}  // namespace talus
