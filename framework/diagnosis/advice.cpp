#include "framework/diagnosis/advice.h"

namespace talus {

Advice advise(const Model& model, const Registry& registry, const Diagnosis& diagnosis,
              const AdviceOptions& options) {
  auto progress = [&](const std::string& step, double share) {
    if (options.progress) options.progress(step, share);
  };
  Advice advice;
  if (!diagnosis.search.stage) return advice;
  const Recordings known = with_circumstances(model, registry, *diagnosis.program,
                                              diagnosis.recordings, fit_before(diagnosis).x);
  const Ground ground{&model, &registry, &known, diagnosis.split.fit, options.threads};
  progress("sensitivity", 0.92);
  StageOptions stage_options;
  stage_options.suspects = options.suspects;
  const Linearised null = linearised(ground, diagnosis.search.null, stage_options);
  advice.seen = seen(diagnosis, null, options.threads);
  progress("curves", 0.95);
  for (std::size_t i = 0; i < diagnosis.search.best.effects.size(); ++i)
    (diagnosis.findings.empty() ? advice.hint_curves : advice.curves)
        .push_back(curve_of(ground, diagnosis.search, i, diagnosis.program->units));
  progress("formulas", 0.96);
  for (std::size_t i = 0; i < diagnosis.findings.size(); ++i)
    advice.formulas.push_back(suggest_formula(ground, diagnosis, i));
  progress("next poses", 0.97);
  advice.next = next_recordings(ground, diagnosis, advice.seen, options);
  return advice;
}

}  // namespace talus
