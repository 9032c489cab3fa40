// `talus axes` and `talus study` as users run them.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/support/command.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;
using nlohmann::json;

namespace {

const std::string knee = shipped("knee-two-axis/model.xml");
const std::string isl = shipped("isl-bonny-2013/");

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// A knee, and the same with its flexion axis moved by 2 mm along x and turned by 2 deg.
struct Knees : Folder {
  Knees() {
    const std::string grid = " --grid 'q1=0:110:10; q2=-15:15:5' --recordings ";
    REQUIRE(command(*this, "simulate '" + knee + "'" + grid + "before.csv").code == 0);
    REQUIRE(command(*this, "simulate '" + knee +
                               "' --seed 2 --set flexion.x=2 --set flexion.yaw=3.718" + grid +
                               "after.csv")
                .code == 0);
    REQUIRE(command(*this, "simulate '" + knee + "' --grid 'q1=0:110:2' --recordings flexed.csv")
                .code == 0);
  }
};

const std::string study = "study '" + isl + "published.xml' '" + isl + "axes.xml' " +
                          "--grid 'flexion_angle=20:80:20; rotation_angle=-15,0,15' "
                          "--vary 'joint2.d=280,300; joint3.a=300' --noise '0.01, 0.02 deg' "
                          "--frames anatomical --by flexion ";

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

}  // namespace

TEST_CASE("axes: where they are, how they changed, as text and as JSON") {
  const Knees folder;
  const Run run = command(folder, "axes '" + knee + "' before.csv after.csv --json axes.json");
  CAPTURE(run.error);
  CHECK(run.code == 0);
  for (const char* words :
       {"Axes in the reference, before.csv", "flexion, still in B", "rotation, still in E",
        "flexion and rotation: angle", "Changes from the reference, the whole motion"}) {
    CAPTURE(words);
    CHECK(contains(run.out, words));
  }
  const json report = json::parse(contents(folder / "axes.json"));
  CHECK(report["command"] == "axes");
  const json& reference = report["whole"]["by_recording"][0];
  CHECK(reference["poses"] == 84);
  CHECK(reference["axes"][0]["determined"] == true);
  CHECK(reference["apart"][0]["distance"].get<double>() == doctest::Approx(8).epsilon(0.1));
  const json& change = report["whole"]["changes"][0]["axes"][0]["variables"];
  CHECK(change[0]["name"] == "flexion.x");
  CHECK(std::abs(change[0]["value"].get<double>() - 2) < 4 * change[0]["std"].get<double>());
  CHECK(std::abs(change[2]["value"].get<double>() - 2) < 4 * change[2]["std"].get<double>());
  const Run quiet = command(folder, "axes '" + knee + "' before.csv --quiet");
  CHECK(quiet.out.empty());
  const Run threads = command(folder, "axes '" + knee + "' before.csv after.csv --threads 3");
  CHECK(threads.out == run.out);
}

TEST_CASE("axes: arcs, true changes, worst arcs") {
  const Knees folder;
  folder.write("actual.csv", "flexion.A-P[mm],flexion.I-E[deg]\n2,2\n");
  const Run run = command(folder, "axes '" + knee +
                                      "' before.csv after.csv --frames anatomical --arcs '20:80, "
                                      "50:110' --actual actual.csv --json axes.json");
  CAPTURE(run.error);
  CHECK(run.code == 0);
  CHECK(contains(run.out, "arc 50:110 deg"));
  CHECK(contains(run.out, "The worst arc of each"));
  const json report = json::parse(contents(folder / "axes.json"));
  REQUIRE(report["worst"].size() == 2);
  CHECK(report["worst"][0]["name"] == "flexion.A-P");
  CHECK(report["worst"][0]["rmse"].get<double>() < 0.4);
  CHECK(report["worst"][1]["rmse"].get<double>() < 0.5);
  CHECK(report["arcs"].size() == 2);
}

TEST_CASE("axes: an axis that the motion does not determine has no numbers") {
  const Knees folder;
  const Run run = command(folder, "axes '" + knee + "' flexed.csv --json axes.json");
  CHECK(run.code == 0);
  CHECK(contains(run.out, "not determined: the rotation about it spreads by only"));
  const json report = json::parse(contents(folder / "axes.json"));
  const json& rotation = report["whole"]["by_recording"][0]["axes"][1];
  CHECK(rotation["determined"] == false);
  CHECK(!rotation.contains("variables"));
  CHECK(report["whole"]["by_recording"][0]["apart"].empty());
}

TEST_CASE("axes: from a linkage's readings") {
  const Folder folder;
  REQUIRE(command(folder, "simulate '" + isl +
                              "validation.xml' --grid 'rotation=-15:15:5; flexion=0:110:10; "
                              "dPD=2.87; dAP=2.87' --noise 0 --recordings poses.csv")
              .code == 0);
  REQUIRE(
      command(folder, "simulate '" + isl + "published.xml' --poses poses.csv --recordings read.csv")
          .code == 0);
  const Run run = command(folder, "axes '" + isl + "axes.xml' read.csv --linkage '" + isl +
                                      "published.xml' --json axes.json");
  CAPTURE(run.error);
  CHECK(run.code == 0);
  CHECK(contains(run.out, "the residuals' spread"));
  const json report = json::parse(contents(folder / "axes.json"));
  const json& apart = report["whole"]["by_recording"][0]["apart"][0];
  CHECK(std::abs(apart["distance"].get<double>() - 158.5) <
        4 * apart["distance_std"].get<double>());
  CHECK(apart["distance_std"].get<double>() < 0.1);
}

TEST_CASE("axes: poses that were not measured are left out") {
  const Knees folder;
  std::string gaps, text = contents(folder / "before.csv");
  std::istringstream in(text);
  int number = 0;
  for (std::string line; std::getline(in, line); ++number)
    gaps += (number % 7 == 5 ? line.substr(0, line.find(',')) + ",,,,,,," : line) + "\n";
  folder.write("gaps.csv", gaps);
  const Run run = command(folder, "axes '" + knee + "' gaps.csv");
  CAPTURE(run.error);
  CHECK(run.code == 0);
  CHECK(contains(run.out, "gaps.csv: 72 poses, residuals "));
  CHECK(command(folder, "axes '" + knee + "' gaps.csv --zero 4 --frames anatomical").code == 2);
}

TEST_CASE("axes: errors in full") {
  const Knees folder;
  folder.write("actual.csv", "flexion.AP[mm]\n2\n");
  folder.write("rows.csv", "flexion.x[mm]\n2\n3\n");
  const auto error = [&](const std::string& arguments) {
    const Run run = command(folder, "axes '" + knee + "' " + arguments);
    CHECK(run.code == 2);
    CHECK(run.out.empty());
    return said(run.error);
  };
  CHECK(error("before.csv --by flexing --arcs 20:80") ==
        "--by flexing: no hinge 'flexing'\n  expected one of: flexion, rotation\n  did you mean "
        "'flexion'?\n");
  CHECK(error("before.csv --arcs 200:300") ==
        "before.csv: 0 poses with 'flexion' in the arc 200:300\n  expected three at the least\n");
  CHECK(error("before.csv after.csv --frames anatomical --actual actual.csv") ==
        "actual.csv:1:1: no variable 'flexion.AP'\n  expected one of: flexion.A-P, flexion.P-D, "
        "flexion.I-E, flexion.V-V, rotation.A-P, rotation.M-L, rotation.F-E, rotation.V-V\n  did "
        "you mean 'flexion.A-P'?\n");
  CHECK(error("before.csv after.csv --actual rows.csv") ==
        "rows.csv: 2 rows\n  expected 1: one per recording after the first\n");
  CHECK(error("before.csv --zero 900 --frames anatomical") ==
        "--zero: no row 900 with a measured pose\n  expected 1 to 84\n");
  CHECK(error("before.csv --labels a,b,c") ==
        "--labels a,b,c: 3 names\n  expected six: along x, y, z, then about x, y, z, such as "
        "A-P,M-L,P-D,V-V,F-E,I-E\n");
  CHECK(contains(error("before.csv --linkage '" + isl + "published.xml'"), "theta1"));
  CHECK(contains(error("flexed.csv --frames anatomical"), "axis 'rotation' is not determined"));
}

TEST_CASE("study: the same table on any number of threads, at once or taken up again") {
  const Folder folder;
  const Run one = command(folder, study + "--trials 6 --threads 1 --table one.csv");
  CAPTURE(one.error);
  REQUIRE(one.code == 0);
  const Run three = command(folder, study + "--trials 6 --threads 3 --table three.csv");
  CHECK(three.code == 0);
  const std::string whole = contents(folder / "one.csv");
  CHECK(contents(folder / "three.csv") == whole);
  CHECK(command(folder, study + "--trials 6").out == whole);
  CHECK(contains(one.out, "Largest root mean square error of any position and any orientation"));
  CHECK(contains(one.out, " of noise: one.csv\n"));
  const std::vector<std::string> lines = lines_of(whole);
  REQUIRE(lines.size() == 2 + 4);
  CHECK(contains(lines[1], "joint2.d,joint3.a,noise[deg],trials,poses,outside,unreachable,"));
  CHECK(contains(lines[1], "flexion.A-P rmse[mm],flexion.A-P se[mm]"));
  for (const std::size_t finished : {0, 1, 3, 4}) {
    CAPTURE(finished);
    std::string begun;
    for (std::size_t i = 0; i < 2 + finished; ++i) begun += lines[i] + "\n";
    folder.write("one.csv", begun);
    CHECK(command(folder, study + "--trials 6 --table one.csv").code == 0);
    CHECK(contents(folder / "one.csv") == whole);
  }
  std::string angles = "rotation_angle[deg],flexion_angle[deg]\n";
  for (const char* flexion : {"20", "40", "60", "80"})
    for (const char* rotation : {"-15", "0", "15"})
      angles += std::string(rotation) + "," + flexion + "\n";
  folder.write("angles.csv", angles);
  const std::string by_table = std::string(study).replace(
      study.find("--grid"), study.find("--vary") - study.find("--grid"), "--poses angles.csv ");
  CHECK(lines_of(command(folder, by_table + "--trials 6").out).size() == lines.size());
  // Errors grow with the noise in step, since the deviates are the same.
  const Recordings table = read_recordings(folder / "one.csv");
  const auto& rmse = table.get("flexion.A-P rmse", length).values;
  CHECK(rmse[1] / rmse[0] == doctest::Approx(2).epsilon(0.01));
}

TEST_CASE("study: a design that cannot follow the motion is said so") {
  const Folder folder;
  const Run run = command(folder, "study '" + isl + "published.xml' '" + isl +
                                      "axes.xml' --grid 'flexion_angle=20:80:30; "
                                      "rotation_angle=-15,15' --vary joint3.a=20 --trials 2");
  CAPTURE(run.error);
  REQUIRE(run.code == 0);
  const std::string row = lines_of(run.out).back();
  CHECK(row.starts_with("20,0.01,0,6,"));
  CHECK(row.ends_with(",,,"));
  const Run table = command(folder, "study '" + isl + "published.xml' '" + isl +
                                        "axes.xml' --grid 'flexion_angle=20:80:30; "
                                        "rotation_angle=-15,15' --vary joint3.a=20 --trials 2 "
                                        "--table study.csv");
  CHECK(contains(table.out, "poses cannot be reached"));
}

TEST_CASE("study: errors in full") {
  const Folder folder;
  const auto error = [&](const std::string& arguments) {
    const Run run = command(folder, arguments);
    CHECK(run.code == 2);
    CHECK(run.out.empty());
    return said(run.error);
  };
  const std::string models = "study '" + isl + "published.xml' '" + isl + "axes.xml' ",
                    grid = models + "--grid 'flexion_angle=20:80:30; rotation_angle=-15,15' ";
  CHECK(error(models) ==
        "talus study: no motion to apply\n  expected --grid \"angle=0:110:10; ...\" or --poses "
        "FILE\n");
  folder.write("angles.csv", "flexion_angle[deg]\n20\n40\n");
  CHECK(contains(error(models + "--poses angles.csv"), "rotation_angle"));
  CHECK(error(grid + "--vary joint3") ==
        "--vary joint3: no attribute with its values\n  expected "
        "element.attribute=first:last:step, or =a,b,c\n");
  CHECK(error(grid + "--vary joint3.a=3:1:1") ==
        "--vary joint3.a=3:1:1: '3:1:1'\n  expected first below last, and a step above zero\n");
  CHECK(contains(error(grid + "--vary joint9.a=3"), "no element 'joint9'"));
  CHECK(contains(error(grid + "--vary joint3.b=3"), "b"));
  CHECK(error(grid + "--noise -1") == "--noise: '-1'\n  expected more than zero\n");
  CHECK(contains(error(models + "--grid flexion_angle=20:80:30"),
                 "axis 'rotation' is not determined"));
  folder.write("other.csv", "a,b\n1,2\n");
  CHECK(error(grid + "--table other.csv") ==
        "other.csv:1: is there already, and is no table of talus study\n  expected a file that "
        "does not exist, or one that the same command began\n");
  REQUIRE(command(folder, grid + "--trials 2 --table study.csv").code == 0);
  const std::string before = contents(folder / "study.csv");
  CHECK(error(grid + "--trials 3 --table study.csv") ==
        "study.csv:1: was begun by talus study with other settings\n  expected the same models "
        "and options to go on with it, or another --table\n");
  CHECK(contents(folder / "study.csv") == before);
}
