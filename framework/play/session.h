// What the teaching page asks of Talus: one request in, one answer out, both JSON text, so that the
// page and a test of the same core on this machine speak the same language. A session keeps the
// model that was read last and the recordings, as the page does.
//
//     {"do": "grammar"}                                     -> {plugins: [...]}: see plugin_json.h
//     {"do": "read", "text": "<talus ...", "file": "m.xml"} -> {scene, rest, values, parameters,
//     elements}
//     {"do": "pose", "coordinates": [30, 45]}               -> {values}
//     {"do": "record", "text": "theta1[deg],...", "file"}   -> {poses}; an empty text forgets them
//     {"do": "residuals"}                                   -> {state, rms}: of the model as it
//     stands
//     {"do": "simulate", "faults": "<talus>...", "poses": 60, "seed": 1, "noise": 1} ->
//     {recordings}
//     {"do": "calibrate", "seed": 1}                        -> {parameters, rms, state, model, ...}
//     {"do": "diagnose", "seed": 1}                         -> {verdict, findings, state, model,
//     ...}
//
// `scene` is what viewer.js shows (its shape is told there), `values` the list of numbers it shows;
// `state` the poses and residuals as in a report's page. `faults` are elements that the simulated
// linkage has and the model does not. Every answer may instead be {error: {text, file, line,
// column}}: the user's input cannot be used, with the place; 0 is unknown.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "framework/kinematics/program.h"
#include "framework/kinematics/tape_values.h"
#include "framework/model/model.h"
#include "framework/recordings/recordings.h"
#include "framework/registry/registry.h"

namespace talus {

class PlaySession {
 public:
  std::string answer(const std::string& request);

 private:
  using Json = nlohmann::ordered_json;
  struct Read {
    std::string file;
    Registry registry;
    Model model;
    Program program;
    TapeValues values;
  };

  Json read(const Json& request);
  Json pose(const Json& request);
  Json record(const Json& request);
  Json residuals();
  Json simulated(const Json& request);
  Json calibrated(const Json& request);
  Json diagnosed(const Json& request);

  Read& model();                                  // InputError where none was read
  Recordings usable(const Program& program);      // the recordings, with what follows from them
  std::string written(const Model& model) const;  // in the syntax that was read

  std::optional<Read> read_;
  std::optional<Recordings> recordings_;
};

}  // namespace talus
