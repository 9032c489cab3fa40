// Small words for tests of whole diagnoses, and recordings for them: of a model with effects added
// to it, and of the spatial linkage at the 65 settings of its fixture.
#pragma once

#include "framework/diagnosis/advice.h"
#include "tests/support/fits.h"

namespace talus::testing {

// The model with these further elements.
inline Model with_elements(Model model, const std::string& elements) {
  Registry registry = Registry::built_in();
  const Model more = read_xml("<talus>" + elements + "</talus>", "effects.xml", registry);
  for (const Element& e : more.root.children) model.root.children.push_back(e);
  return model;
}

// The shipped recordings' readings, what the model with these further elements measures there.
inline Recordings isl_recordings(const std::string& effects, std::uint64_t seed = 5) {
  Program program =
      program_of(with_elements(model_of(shipped("isl-bonny-2013/published.xml")), effects));
  Settings settings;
  const Recordings given = read_recordings(shipped("isl-bonny-2013/recordings.csv"));
  for (std::size_t k = 0; k < given.rows(); ++k) {
    auto& pose = settings.poses.emplace_back();
    for (const Reading& r : program.readings) pose.push_back(given.get(r.column, angle).values[k]);
  }
  return simulate(program, settings, {seed, 1, 1});
}

struct Diagnosed {
  Model model;
  Registry registry = Registry::built_in();
  Recordings recordings;
  Split split;
  Diagnosis diagnosis;
  Advice advice;
};

inline Diagnosed diagnosed(Model model, Recordings recordings,
                           const std::vector<std::string>& only = {}) {
  Diagnosed d;
  d.model = std::move(model);
  d.recordings = std::move(recordings);
  d.split = random_split(d.recordings, 1);
  DiagnosisOptions options;
  options.search.suspects.only = only;
  d.diagnosis = diagnose(d.model, d.registry, d.recordings, d.split, options);
  AdviceOptions advice;
  advice.suspects.only = only;
  d.advice = advise(d.model, d.registry, d.diagnosis, advice);
  return d;
}

// "effect@location" of the only finding; empty where there is none or more than one.
inline std::string named(const Diagnosis& d) {
  return d.findings.size() == 1 ? d.findings[0].effect + "@" + d.findings[0].location : "";
}

inline Diagnosed diagnosed(const std::string& file, Recordings recordings,
                           const std::vector<std::string>& only = {}) {
  Registry registry = Registry::built_in();
  return diagnosed(read_model(file, registry), std::move(recordings), only);
}

}  // namespace talus::testing
