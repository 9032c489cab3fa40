// One --set changes what is made small, as users run it: no noise on standard error, and a clear
// word where a residual does not go with what is measured.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/command.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

namespace {

const std::string isl = shipped("isl-bonny-2013/"), device = shipped("device-nordquist-2009/");

Run calibrated(const Folder& folder, const std::string& of, const std::string& set) {
  return command(folder, "calibrate '" + of + "model.xml' '" + of +
                             "recordings.csv' --quiet --json fit.json --set '" + set + "'");
}

}  // namespace

TEST_CASE("residuals and objectives swapped by --set") {
  const Folder folder;
  for (const char* set :
       {"residual=position, inverse_direction_cosines", "residual=vector_length, projection_angles",
        "residual=inverse_direction_cosines, vector_length", "objective=as_published",
        "loss=huber 2"}) {
    CAPTURE(set);
    const Run run = calibrated(folder, isl, set);
    CHECK(run.code == 0);
    CHECK(run.out.empty());
    CHECK(run.error.empty());
  }
  // Starts on the way have no derivatives here; nothing but Talus' own words is seen of that.
  for (const char* set : {"residual=vector_length", "residual=inverse_direction_cosines",
                          "objective=as_published", "objective=least_squares"}) {
    CAPTURE(set);
    const Run run = calibrated(folder, device, set);
    CHECK(run.code == 0);
    CHECK(run.error.find("Logging") == std::string::npos);
    CHECK(run.error.find("Terminating") == std::string::npos);
  }
}

TEST_CASE("a residual that nothing measured goes with") {
  const Folder folder;
  const Run run = calibrated(folder, device, "residual=projection_angles, vector_length");
  CHECK(run.code == 2);
  CHECK(run.out.empty());
  CHECK(run.error.substr(run.error.find("residual '")) ==
        "residual 'projection_angles' fits none of the measured features\n  expected for P "
        "(scalar), IDC (direction): direction, distance, inverse_direction_cosines, "
        "vector_length\n");
  CHECK(folder.files().empty());
}

TEST_CASE("without priors every tolerance counts as a question mark") {
  const Folder folder;
  std::string text = contents(shipped("arm-6r/model.xml"));
  REQUIRE(text.find(" ± ") != std::string::npos);
  folder.write("toleranced.xml", text);
  for (std::size_t at; (at = text.find(" ± ")) != std::string::npos;)
    text.replace(at, text.find_first_not_of("0123456789.", at + std::string(" ± ").size()) - at,
                 " ?");
  folder.write("free.xml", text);
  REQUIRE(command(folder, "simulate toleranced.xml --poses 40 --seed 3 --recordings r.csv").code ==
          0);
  REQUIRE(command(folder, "calibrate toleranced.xml r.csv --without-priors --quiet --json a.json")
              .code == 0);
  REQUIRE(command(folder, "calibrate free.xml r.csv --quiet --json b.json").code == 0);
  REQUIRE(command(folder, "calibrate toleranced.xml r.csv --quiet --json c.json").code == 0);
  auto values = [&](const char* file) {
    return nlohmann::json::parse(contents(folder / file))["baseline"]["parameters"];
  };
  const auto a = values("a.json"), b = values("b.json"), c = values("c.json");
  REQUIRE(a.size() == b.size());
  double moved = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i]["value"] == b[i]["value"]);
    CHECK(a[i]["tolerance"].is_null());
    moved += std::abs(a[i]["value"].get<double>() - c[i]["value"].get<double>());
  }
  CHECK(moved > 1e-6);
}

TEST_CASE("a quaternion that is none, and a table written over its own source, are refused") {
  const Folder folder;
  std::string text = contents(isl + "recordings.csv");
  const auto row = text.find("\n3,") + 1, end = text.find('\n', row);
  const auto quaternion =
      text.rfind(',', text.rfind(',', text.rfind(',', text.rfind(',', end) - 1) - 1) - 1);
  folder.write("r.csv", text.replace(quaternion, end - quaternion, ",0,0,0,0"));
  Run run = command(folder, "calibrate '" + isl + "model.xml' r.csv");
  CHECK(run.code == 2);
  CHECK(said(run.error) ==
        "r.csv:5: the quaternion of 'E' has length 0\n  expected a unit quaternion: w, x, y, z\n");
  const std::string before = contents(folder / "r.csv");
  run = command(folder, "motion '" + isl + "published.xml' r.csv --table r.csv");
  CHECK(run.code == 2);
  CHECK(said(run.error) == "r.csv: would be written over what is read\n  expected another file\n");
  CHECK(contents(folder / "r.csv") == before);
}
