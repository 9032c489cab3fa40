// The requests of a session that simulate and solve.
#include <cmath>

#include "framework/calibration/circumstances.h"
#include "framework/calibration/closing.h"
#include "framework/calibration/fit.h"
#include "framework/calibration/simulate.h"
#include "framework/calibration/split_options.h"
#include "framework/diagnosis/diagnosis.h"
#include "framework/dsl/dsl.h"
#include "framework/dsl/read.h"
#include "framework/page/page_state.h"
#include "framework/play/session.h"
#include "framework/report/diagnosis_report.h"
#include "framework/report/json_parts.h"
#include "framework/report/verdict.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

Split split_of(const Program& program, const Recordings& recordings, const Json& request) {
  return split_rows(recordings, split_options(program, recordings, request.value("check", 0.3), {},
                                              request.value("seed", 1)));
}

// The linkage that is simulated: elements with a known name change those of the model, others are
// added to it.
Model with_faults(Model model, const std::string& faults, const Registry& registry) {
  if (faults.empty()) return model;
  const Element planted = parse_xml(faults, "faults");
  for (const Element& fault : planted.children) {
    Element* known = fault.name().empty() ? nullptr : model.root.find_named(fault.name());
    if (!known) {
      model.root.children.push_back(fault);
      continue;
    }
    for (const Attribute& a : fault.attributes) known->set(a.name, a.text);
  }
  check_grammar(model, registry);
  return model;
}

// Root mean square of the rows in stated sigmas, of the model as it stands.
Json rms_of(const Program& program, const Recordings& recordings) {
  std::vector<std::size_t> rows(recordings.rows());
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = k;
  const Groups groups(program, recordings);
  Problem problem(program, recordings, rows, groups, {});
  if (!problem.noise_known()) return nullptr;
  problem.set_weights(problem.start());
  const Problem::Residuals residuals = problem.residuals(problem.start());
  double sum = 0;
  std::size_t count = 0;
  for (Eigen::Index i = 0; i < residuals.raw.size(); ++i)
    if (!std::isnan(residuals.raw.data()[i]))
      sum += std::pow(residuals.whitened.data()[i], 2), ++count;
  const auto independent = static_cast<double>(count) - problem.dependent_rows();
  return independent > 0 ? Json(std::sqrt(sum / independent)) : Json(nullptr);
}

}  // namespace

Json PlaySession::residuals() {
  const Program& program = model().program;
  const Recordings recordings = usable(program);
  return {{"state", json_of(given_state("model", program, recordings, 1))},
          {"rms", rms_of(program, recordings)}};
}

Json PlaySession::simulated(const Json& request) {
  const Read& read = model();
  Program program =
      compile(with_faults(read.model, request.value("faults", ""), read.registry), read.registry);
  const int poses = request.value("poses", 60);
  SimulateOptions options;
  options.seed = request.value("seed", 1);
  options.noise = request.value("noise", 1.0);
  Settings settings;
  if (has_loops(program)) {
    ClosingOptions closing;
    closing.noise = options.noise, closing.seed = options.seed;
    settings = random_closed_settings(program, poses, closing);
  } else {
    settings = random_settings(program, poses, options.seed);
  }
  return {{"recordings", write_recordings(simulate(program, settings, options))}};
}

Json PlaySession::calibrated(const Json& request) {
  const Read& read = model();
  const Program& program = read.program;
  Recordings recordings = usable(program);
  FitOptions options;
  options.seed = request.value("seed", 1);
  const Split split = split_of(program, recordings, request);
  Fit fit = calibrate(program, recordings, split, options);
  if (depends_on_loads(program)) {  // once more, with the loads at the geometry found
    recordings = with_derived(program, recordings, fit.x);
    fit = calibrate(program, recordings, split, options);
  }
  Json out = json_of(fit, program.units);
  const Spoken verdict = verdict_of_fit(program, fit);
  out["verdict"] = {{"headline", verdict.headline}, {"sentences", verdict.sentences}};
  out["converged"] = fit.converged;
  out["stopped"] = fit.stopped;
  out["warnings"] = fit.warnings;
  out["state"] = json_of(fitted_state("calibrated", program, recordings, fit));
  out["model"] = written(calibrated_model(read.model, program, fit));
  return out;
}

Json PlaySession::diagnosed(const Json& request) {
  const Read& read = model();
  const Recordings recordings = usable(read.program);
  DiagnosisOptions options;
  options.fit.seed = options.search.seed = request.value("seed", 1);
  const Diagnosis d = diagnose(read.model, read.registry, recordings,
                               split_of(read.program, recordings, request), options);
  Json out{{"verdict", to_string(d.verdict)}, {"sentence", sentence_of(d)}};
  out["heldout"] = sentence_of(d.heldout, fit_before(d));
  for (const char* list : {"findings", "hints"}) {
    out[list] = Json::array();
    for (const Finding& f : list == std::string("findings") ? d.findings : d.hints)
      out[list].push_back({{"effect", f.effect},
                           {"location", f.location},
                           {"probability", f.probability},
                           {"sentence", sentence_of(f)},
                           {"values", values_in_words(f)}});
  }
  out["warnings"] = d.warnings;
  out["before"] = json_of(fit_before(d), d.program->units);
  out["after"] = json_of(d.after, d.program_after->units);
  out["state"] =
      json_of(fitted_state("with what was found", *d.program_after, d.recordings, d.after));
  out["model"] = written(calibrated_model(d.extended_model, *d.program_after, d.after));
  return out;
}

}  // namespace talus
