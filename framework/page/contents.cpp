#include "framework/page/contents.h"

#include <algorithm>
#include <cmath>

#include "framework/page/page_state.h"
#include "framework/report/diagnosis_report.h"
#include "framework/report/layout.h"

namespace talus {
namespace {

void tell(PageContent& content, const Spoken& verdict) {
  content.headline = verdict.headline;
  content.sentences = verdict.sentences;
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

std::vector<char> use_of(std::size_t rows, const Split& split) {
  std::vector<char> use(rows, '-');
  for (const std::size_t k : split.fit) use[k] = 'f';
  for (const std::size_t k : split.check) use[k] = 'c';
  return use;
}

}  // namespace

void page_of_model(PageContent& content, const Program& program) {
  content.title = program.name;
  tell(content, verdict_of_model(program));
  content.states.push_back({"nominal", &program, {}});
}

void page_of_check(PageContent& content, const Program& program, const Recordings& recordings,
                   const Spoken& verdict, const Identifiability& seen, std::span<const double> x) {
  page_of_model(content, program);
  tell(content, verdict);
  content.states[0] = given_state("nominal", program, recordings, 1);
  content.states[0].parameters.assign(x.begin(), x.end());
  content.recordings = &recordings;
  content.directions = directions(seen, program, 0);
}

void page_of_simulation(PageContent& content, const Program& program, const Settings& settings,
                        const Recordings& recordings) {
  content.title = program.name;
  content.headline = counted(settings.poses.size(), "pose", "poses") + " simulated";
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
  tell(content, verdict_of_fit(program, fit));
  content.sentences.insert(content.sentences.end(), fit.warnings.begin(), fit.warnings.end());
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
  tell(content, verdict_of_axes(result, names));
  for (std::size_t r = 0; r < result.whole.located.size(); ++r) {
    content.states.push_back(
        fitted_state(names[r], program, recordings[r], result.whole.located[r].fit));
    content.states.back().apart = r > 0;
  }
  std::rotate(content.states.begin(), content.states.begin() + 1, content.states.end());
  content.recordings = &recordings[0];
  content.use.assign(recordings[0].rows(), 'f');
}

}  // namespace talus
