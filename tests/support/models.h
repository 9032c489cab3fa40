// Models and recordings for the tests of kinematics and calibration: the models that are shipped,
// models written in a test, and recordings of them.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "framework/calibration/simulate.h"
#include "framework/dsl/dsl.h"
#include "framework/kinematics/program.h"
#include "tests/support/derivative_check.h"

namespace talus::testing {

inline std::string shipped(const std::string& file) { return TALUS_SOURCE_DIR "/models/" + file; }

// The XML models that are shipped, in alphabetical order; what stands in a folder `parts` is for
// including and no model by itself.
inline std::vector<std::string> shipped_models(const std::string& ending = ".xml") {
  std::vector<std::string> files;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(TALUS_SOURCE_DIR "/models"))
    if (entry.path().extension() == ending && entry.path().parent_path().filename() != "parts")
      files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

inline Model model_of(const std::string& file) {
  Registry registry = Registry::built_in();
  return read_model(file, registry);
}

inline Program program_of(const Model& model) { return compile(model, Registry::built_in()); }
inline Program program_of(const std::string& file) {
  Registry registry = Registry::built_in();  // and what the model names
  return compile(read_model(file, registry), registry);
}
inline Program program_from(const std::string& xml) {
  Registry registry = Registry::built_in();
  return compile(read_xml(xml, "model.xml", registry), registry);
}

// "joint2.a" of a model set to a text.
inline Element* find_named(Element& element, const std::string& name) {
  for (Element& child : element.children) {
    if (child.name() == name) return &child;
    if (Element* found = find_named(child, name)) return found;
  }
  return nullptr;
}
inline void set(Model& model, const std::string& name, const std::string& text) {
  const auto dot = name.find('.');
  Element* element = find_named(model.root, name.substr(0, dot));
  REQUIRE_MESSAGE(element, name);
  element->set(name.substr(dot + 1), text);
}
inline void set_calibrate(Model& model, const std::string& attribute, const std::string& text) {
  for (Element& child : model.root.children)
    if (child.tag == "calibrate") child.set(attribute, text);
}

// The model with its unknowns per pose turned into readings, so that their values can be chosen.
inline Model with_readings_for_unknowns(Model model, const std::string& range) {
  for (Element& e : model.root.children)
    if (e.tag == "unknown") {
      e.tag = "encoder";
      std::erase_if(e.attributes, [](const Attribute& a) { return a.name != "name"; });
      e.set("range", range);
    }
  return model;
}

inline double gauss(Random& random) {
  const double u = between(random, 1e-12, 1), v = between(random, 0, 2 * 3.14159265358979323846);
  return std::sqrt(-2 * std::log(u)) * std::cos(v);
}

// The same program with its parameters drawn from their tolerances: a truth to simulate from.
inline std::vector<double> draw_truth(Program& program, std::uint64_t seed, double share = 1) {
  Random random(seed);
  std::vector<double> truth;
  for (Parameter& p : program.parameters) {
    p.nominal.value += share * p.nominal.tolerance.value_or(0) * gauss(random);
    truth.push_back(p.nominal.value);
  }
  return truth;
}

inline std::vector<std::size_t> all_rows(const Recordings& recordings) {
  std::vector<std::size_t> rows(recordings.rows());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return rows;
}

inline RecordedColumn& column(Recordings& recordings, const std::string& name) {
  const auto it = std::find_if(recordings.columns.begin(), recordings.columns.end(),
                               [&](const RecordedColumn& c) { return c.name == name; });
  REQUIRE_MESSAGE(it != recordings.columns.end(), name);
  return *it;
}

inline void add_column(Recordings& recordings, const std::string& name,
                       std::vector<double> values) {
  std::erase_if(recordings.columns, [&](const RecordedColumn& c) { return c.name == name; });
  recordings.columns.push_back({name, *parse_unit("1"), std::move(values), {}});
}

// `count` random poses of a program, with noise from its sigmas times `noise`.
inline Recordings recorded(const Program& program, int count, std::uint64_t seed,
                           double noise = 1) {
  return simulate(program, random_settings(program, count, seed), {.seed = seed, .noise = noise});
}

}  // namespace talus::testing
