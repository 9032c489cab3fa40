// Shipped models to try diagnosis on: recordings of each, with a truth drawn from its tolerances,
// by itself or with something left out of the model.
#pragma once

#include <functional>

#include "tests/support/fits.h"

namespace talus::testing {

struct Bed {
  std::string file;
  int poses;
  double share;                   // of the tolerances, by which the truth is off nominal
  bool latent;                    // its coordinates are not read
  std::string joint, coordinate;  // one that a test may disturb
};

inline const std::vector<Bed>& beds() {
  static const std::vector<Bed> all = {
      {"isl-bonny-2013/model.xml", 100, 1, false, "joint3.theta", "encoder3"},
      {"device-nordquist-2009/model.xml", 120, 0.2, false, "joint2.theta", "micrometer2"},
      {"arm-6r/model.xml", 160, 1, false, "joint3.theta", "encoder3"},
      {"ankle-storey-2006/model.xml", 150, 0.5, true, "subtalar.theta", "q2"},
      {"knee-two-axis/model.xml", 150, 0.5, true, "flexion.theta", "q1"}};
  return all;
}
inline const Bed& arm() { return beds()[2]; }

struct Simulated {
  Program program;  // as shipped
  Recordings recordings;
  Split split;
};

using Change = std::function<void(Model&)>;

// Recorded by the shipped model after the change.
inline Recordings record(const Bed& bed, std::uint64_t seed, const Change& change = nullptr,
                         double noise = 1) {
  Model model = model_of(shipped(bed.file));
  if (bed.latent) model = with_readings_for_unknowns(model, "-40, 40");
  if (change) change(model);
  Program truth = program_of(model);
  draw_truth(truth, seed, bed.share);
  return recorded(truth, bed.poses, seed, noise);
}

inline Simulated simulated(const Bed& bed, std::uint64_t seed, const Change& change = nullptr,
                           double noise = 1) {
  Recordings recordings = record(bed, seed, change, noise);
  Split split = random_split(recordings, seed);
  return {program_of(shipped(bed.file)), std::move(recordings), std::move(split)};
}

// The disturbed joint's coordinate as an expression of itself: "{} + 0.1 deg*sin({})".
inline Change disturbed(const Bed& bed, std::string expression) {
  for (std::size_t at; (at = expression.find("{}")) != std::string::npos;)
    expression.replace(at, 2, bed.coordinate);
  return [=](Model& model) { set(model, bed.joint, expression); };
}

inline void replace_rows(Recordings& recordings, const Recordings& by, std::size_t from) {
  for (std::size_t c = 0; c < recordings.columns.size(); ++c)
    for (std::size_t k = from; k < recordings.rows(); ++k)
      recordings.columns[c].values[k] = by.columns[c].values[k];
}

}  // namespace talus::testing
