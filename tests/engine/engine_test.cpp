// What talus diagnose makes of recordings that an independent physics engine has made
// (main.cpp in this folder). scripts/figures/engine does the same for many more.
#include <nlohmann/json.hpp>

#include "tests/support/command.h"
#include "tests/support/models.h"

using namespace talus::testing;

namespace {

#ifdef TALUS_ENGINE
// Three standard deviations above 1 for the root mean square of 30 poses with three rows each.
constexpr double kAsNoise = 1.22;

nlohmann::json diagnosed(const std::string& linkage, const std::string& flaws) {
  const Folder folder;
  const std::string table = folder / "recordings.csv";
  REQUIRE(shell("'" TALUS_ENGINE "' " + linkage + " '" + table + "' " + flaws) == 0);
  const std::string model = linkage == "isl" ? "isl-bonny-2013/model.xml" : "arm-6r/model.xml";
  const Run run = command(folder, "diagnose '" + shipped(model) +
                                      "' recordings.csv --next-count 0 --quiet --json d.json");
  CAPTURE(run.error);
  REQUIRE(run.code == 0);
  return nlohmann::json::parse(contents(folder / "d.json"));
}

void check_named(const std::string& linkage, const std::string& flaw, const std::string& effect,
                 const std::string& location) {
  const nlohmann::json d = diagnosed(linkage, "--seed 1 --flaw " + flaw);
  CAPTURE(linkage + " " + flaw + ": " + d["statement"].get<std::string>());
  CHECK(d["verdict"] == "explained");
  REQUIRE(d["findings"].size() == 1);
  CHECK(d["findings"][0]["effect"] == effect);
  CHECK(d["findings"][0]["location"] == location);
  CHECK(d["heldout"]["after"] < kAsNoise);
}
#endif

}  // namespace

TEST_CASE("recordings of a physics engine are diagnosed by what the engine built") {
#ifdef TALUS_ENGINE
  for (const char* linkage : {"isl", "arm"}) {
    const nlohmann::json d = diagnosed(linkage, "--seed 1");
    CHECK(d["verdict"] == "nothing-missing");
    CHECK(d["heldout"]["after"] < kAsNoise);
  }
  check_named("arm", "elastic:3:0.001", "joint_compliance", "joint3");
  check_named("arm", "bending:2:0.0001:2", "link_bending", "link2");
  check_named("arm", "play_load:2:0.02", "backlash", "joint2");
  check_named("isl", "eccentric:3:0.01:60", "encoder_eccentricity", "encoder3");
  check_named("isl", "bending:3:0.1", "link_bending", "link3");
#else
  MESSAGE("skipped, the physics engine is not installed (scripts/setup --engine)");
#endif
}
