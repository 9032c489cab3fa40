// Recordings made by another program, where they lie beside the repository (they are not part of
// it): of known devices, with effects that a key tells.
#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace talus::testing {

inline const std::string beside = TALUS_SOURCE_DIR "/../shared/";

inline bool there(const std::string& file) {
  if (std::filesystem::exists(beside + file)) return true;
  MESSAGE("skipped, not beside the repository: ", file);
  return false;
}

// check(id, key, model file, recordings file) of every case of a device whose model is shipped.
template <class F>
void each_case(const F& check) {
  if (!there("cases/keys.json")) return;
  std::ifstream in(beside + "cases/keys.json");
  const nlohmann::json keys = nlohmann::json::parse(in);
  const std::map<std::string, std::string> models{{"isl6", "isl-bonny-2013"},
                                                  {"arm6", "arm-6r"},
                                                  {"cal3", "device-nordquist-2009"},
                                                  {"ankle2", "ankle-storey-2006"},
                                                  {"knee2", "knee-two-axis"}};
  for (const auto& item : keys.items()) {
    const std::string id = item.key(), device = item.value()["device"],
                      file = beside + "cases/" + device + "/" + id + "/recordings.csv";
    if (!models.contains(device) || !std::filesystem::exists(file)) continue;
    CAPTURE(id);
    check(id, item.value(), TALUS_SOURCE_DIR "/models/" + models.at(device) + "/model.xml", file);
  }
}

}  // namespace talus::testing
