// One --set changes what is made small, as users run it: no noise on standard error, and a clear
// word where a residual does not go with what is measured.
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
