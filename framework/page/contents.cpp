#include "framework/page/contents.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/page/page_state.h"
#include "framework/report/diagnosis_report.h"

namespace talus {
namespace {

std::string poses_text(std::size_t n) { return fmt::format("{} {}", n, n == 1 ? "pose" : "poses"); }

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

std::vector<PageDirection> directions(const Identifiability& seen, const Program& program,
                                      std::size_t state) {
  std::vector<PageDirection> out;
  for (std::size_t i = 0; i < seen.unseen.size(); ++i) {
    PageDirection direction{seen.unseen[i], state, {}};
    if (static_cast<Eigen::Index>(i) < seen.directions.cols())
      for (std::size_t p = 0; p < program.parameters.size(); ++p)
        if (const double v =
                seen.directions(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(i));
            v != 0 && std::isfinite(v))
          direction.changes.push_back({program.parameters[p].slot, v});
    out.push_back(std::move(direction));
  }
  return out;
}

void tell_seen(PageContent& content, const Identifiability& seen) {
  if (seen.unseen.empty())
    content.sentences.push_back("Every direction in the space of the free parameters is seen.");
  else
    content.sentences.push_back(fmt::format(
        "{} of {} directions in the space of the free parameters are seen; the others keep their "
        "tolerance and can be played as motion below.",
        seen.seen, static_cast<std::size_t>(seen.seen) + seen.unseen.size()));
}

std::vector<char> use_of(std::size_t rows, const Split& split) {
  std::vector<char> use(rows, '-');
  for (const std::size_t k : split.fit) use[k] = 'f';
  for (const std::size_t k : split.check) use[k] = 'c';
  return use;
}

}  // namespace

void page_of_model(PageContent& content, const Program& program) {
  content.title = program.name;
  content.headline =
      fmt::format("A linkage of {} joint{} and {} free parameter{}", program.frames.size() - 1,
                  program.frames.size() == 2 ? "" : "s", program.parameters.size(),
                  program.parameters.size() == 1 ? "" : "s");
  content.sentences.push_back("The model is sound: every name, unit and frame was found.");
  content.states.push_back({"nominal", &program, {}});
}

void page_of_check(PageContent& content, const Program& program, const Recordings& recordings,
                   const Identifiability& seen, std::span<const double> x) {
  page_of_model(content, program);
  content.states[0] = given_state("nominal", program, recordings, 1);
  content.states[0].parameters.assign(x.begin(), x.end());
  content.recordings = &recordings;
  content.sentences.push_back(
      fmt::format("{} of recordings fit it; residuals are those at the nominal values.",
                  poses_text(recordings.rows())));
  tell_seen(content, seen);
  content.directions = directions(seen, program, 0);
}

void page_of_simulation(PageContent& content, const Program& program, const Settings& settings,
                        const Recordings& recordings) {
  content.title = program.name;
  content.headline = fmt::format("{} simulated", poses_text(settings.poses.size()));
  content.sentences.push_back(
      "Recordings made from the model, with noise of its stated sigmas and the effects it has.");
  PageState state{"simulated", &program, {}};
  state.poses = settings.poses;
  state.recordings = &recordings;
  content.states.push_back(std::move(state));
  content.recordings = &recordings;
}

void page_of_fit(PageContent& content, const Program& program, const Recordings& recordings,
                 const Split& split, const Fit& fit) {
  content.title = program.name;
  if (!fit.converged)
    content.headline = "The fit did not converge";
  else if (!fit.noise_known)
    content.headline = "Fitted; whether what is left is noise cannot be told without stated sigmas";
  else if (fit.chi2_p < 0.001)
    content.headline = "Fitted, but more is left than the stated noise explains";
  else
    content.headline = "The stated noise explains what the fit leaves";
  if (fit.poses_check > 0)
    content.sentences.push_back(fmt::format(
        "On {} held out the residuals are {:.3g} {} (root mean square; {} fitted: {:.3g}): {}.",
        poses_text(fit.poses_check), fit.heldout_rms,
        fit.noise_known ? "stated sigmas" : "times the noise that the fit leaves",
        poses_text(fit.poses_fit), fit.fit_rms, errors_text(fit.measures_check, program.units)));
  else
    content.sentences.push_back(fmt::format(
        "No rows were held out. On the {} fitted the residuals are {:.3g} (root mean square): {}.",
        poses_text(fit.poses_fit), fit.fit_rms, errors_text(fit.measures_fit, program.units)));
  tell_seen(content, fit.seen);
  content.sentences.insert(content.sentences.end(), fit.warnings.begin(), fit.warnings.end());
  if (fit.noise_known && fit.chi2_p < 0.001)
    content.sentences.emplace_back("talus diagnose asks what physics the model leaves out.");
  content.states.push_back(given_state("nominal", program, recordings, 1));
  content.states.push_back(fitted_state("calibrated", program, recordings, fit));
  content.recordings = &recordings;
  content.use = use_of(recordings.rows(), split);
  content.directions = directions(fit.seen, program, 1);
}

void page_of_diagnosis(PageContent& content, const Diagnosis& d, const Advice& advice,
                       const Recordings& before, const Recordings& after) {
  content.title = d.program->name;
  content.headline = sentence_of(d);
  if (const std::string heldout = sentence_of(d.heldout, d.baseline); !heldout.empty())
    content.sentences.push_back(heldout);
  for (const Finding& f : d.findings) content.sentences.push_back(sentence_of(f));
  for (const Outlier& o : d.outliers.found) content.sentences.push_back(o.statement);
  for (const Fault& f : d.faults) content.sentences.push_back(f.statement);
  if (!d.noise.statement.empty()) content.sentences.push_back(d.noise.statement);
  for (const std::string& warning : d.warnings) content.sentences.push_back(warning);
  const Program& program = *d.program;
  content.states.push_back(given_state("nominal", program, before, 1));
  content.states.push_back(fitted_state("as given, fitted", program, before, fit_before(d)));
  const bool found = !d.findings.empty();
  if (found)
    content.states.push_back(fitted_state("with the findings", *d.program_after, after, d.after));
  content.recordings = &before;
  content.use = use_of(before.rows(), d.split);
  content.directions = directions(found ? d.after.seen : fit_before(d).seen,
                                  found ? *d.program_after : program, found ? 2 : 1);
  content.curves = advice.curves;
  content.curves.resize(d.findings.size());
  content.curves.insert(content.curves.end(), advice.hint_curves.begin(), advice.hint_curves.end());
  for (const NextPose& pose : advice.next.poses) {
    content.next.emplace_back();
    for (std::size_t i = 0; i < pose.coordinates.size(); ++i)
      content.next.back().push_back(pose.coordinates[i] /
                                    program.units.of(advice.next.dimensions[i]).factor);
  }
}

void page_of_axes(PageContent& content, const AxisFinder& finder, const AxesResult& result,
                  const std::vector<Recordings>& recordings,
                  const std::vector<std::string>& names) {
  const Program& program = finder.program();
  content.title = program.name;
  std::size_t determined = 0;
  for (const LocatedAxis& a : result.whole.located[0].axes) determined += a.determined;
  content.headline =
      fmt::format("{} of {} axes were located", determined, result.whole.located[0].axes.size());
  for (std::size_t r = 0; r < result.whole.located.size(); ++r) {
    const Fit& fit = result.whole.located[r].fit;
    content.sentences.push_back(fmt::format(
        "{}: {}, {:.3g} {} (root mean square).", names[r], poses_text(fit.poses_fit), fit.fit_rms,
        fit.noise_known ? "stated sigmas" : "times the noise that the fit leaves"));
    content.states.push_back(fitted_state(names[r], program, recordings[r], fit));
    content.states.back().apart = r > 0;
  }
  std::rotate(content.states.begin(), content.states.begin() + 1, content.states.end());
  content.recordings = &recordings[0];
  content.use.assign(recordings[0].rows(), 'f');
}

}  // namespace talus
