// talus diagnose as users run it.
#include <nlohmann/json.hpp>

#include "framework/recordings/recordings.h"
#include "tests/support/command.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

TEST_CASE("diagnose writes the poses to record next, which simulate reads") {
  const Folder folder;
  const std::string model = shipped("isl-bonny-2013/model.xml"),
                    recordings = shipped("isl-bonny-2013/recordings.csv");
  const std::string call = "diagnose '" + model + "' '" + recordings + "' --next next.csv";
  const Run run = command(folder, call + " --json one.json --threads 1");
  CAPTURE(run.error);
  REQUIRE(run.code == 0);
  CHECK(run.out.starts_with("NOTHING MISSING. "));
  CHECK(run.out.find("talus simulate '") == std::string::npos);
  CHECK(run.out.find("--poses next.csv") != std::string::npos);

  const Recordings next = read_recordings(folder / "next.csv");
  CHECK(next.rows() == 8);
  const Run simulated =
      command(folder, "simulate '" + model + "' --poses next.csv --noise 0 --recordings then.csv");
  CAPTURE(simulated.error);
  CHECK(simulated.code == 0);
  const Recordings then = read_recordings(folder / "then.csv");
  REQUIRE(then.rows() == 8);
  CHECK(then.get("theta3", angle).values[2] ==
        doctest::Approx(next.get("theta3", angle).values[2]).epsilon(1e-9));

  // The same on any number of threads.
  const Run again = command(folder, call + " --json two.json --threads 3");
  CHECK(again.out == run.out);
  const auto one = nlohmann::json::parse(contents(folder / "one.json")),
             two = nlohmann::json::parse(contents(folder / "two.json"));
  CHECK(one["next_poses"] == two["next_poses"]);
  CHECK(one["sensitivity"] == two["sensitivity"]);

  const Run details = command(folder, "diagnose '" + model + "' '" + recordings +
                                          "' --details --sensitivity --next-count 0");
  CHECK(details.out.find("encoder eccentricity  ") != std::string::npos);
  CHECK(details.out.find("What to record next") == std::string::npos);
  CHECK(command(folder, "diagnose '" + model + "' '" + recordings + "' --next '" + model + "'")
            .code == 2);
}
