// An effect in a Lua file, of which the model to be diagnosed knows nothing, is found where it
// acts.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "tests/support/command.h"

using namespace talus::testing;

TEST_CASE("diagnose finds a Lua effect that the recordings were simulated with") {
  const std::string arm = TALUS_SOURCE_DIR "/models/arm-6r/";
  const Folder folder;
  std::string model = contents(arm + "model.xml");
  model.insert(model.find("</talus>"), "<detent at=\"encoder4\" height=\"0.15\" teeth=\"10\"/>");
  folder.write("sick.xml", model);
  const std::string plugin = " --plugin '" + arm + "parts/detent.lua' ";
  const Run simulated =
      command(folder, "simulate sick.xml --poses 120 --seed 3 --recordings poses.csv" + plugin);
  CHECK(simulated.error == "");
  REQUIRE(simulated.code == 0);
  const Run diagnosed =
      command(folder, "diagnose '" + arm + "model.xml' poses.csv --json - --out ." + plugin);
  CHECK(diagnosed.error == "");
  REQUIRE(diagnosed.code == 0);
  const auto report = nlohmann::json::parse(diagnosed.out);
  REQUIRE(report["findings"].size() == 1);
  const auto& finding = report["findings"][0];
  CHECK(finding["effect"] == "detent");
  CHECK(finding["location"] == "encoder4");
  REQUIRE(!finding["parameters"].empty());
  CHECK(finding["parameters"][0]["name"] == "height");
  CHECK(finding["parameters"][0]["value"].get<double>() == doctest::Approx(0.15).epsilon(0.1));
  // The extended model reads back with the plugin, and fits.
  CHECK(command(folder, "check model-extended.xml" + plugin).code == 0);
}
