// The command as users run it: what it prints, writes and ends with.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/support/command.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;
using nlohmann::json;

namespace {

const std::string arm = shipped("arm-6r/model.xml");

// A folder with recordings of the arm in it.
struct RecordedFolder : Folder {
  explicit RecordedFolder(const std::string& model = arm, int poses = 60) {
    const Run run = command(*this, "simulate '" + model + "' --poses " + std::to_string(poses) +
                                       " --recordings poses.csv");
    CAPTURE(run.error);
    REQUIRE(run.code == 0);
  }
};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("calibrate prints a report and writes the calibrated model, which calibrates again") {
  const RecordedFolder folder;
  const Run run = command(folder, "calibrate '" + arm + "' poses.csv");
  CAPTURE(run.error);
  CHECK(run.code == 0);
  for (const char* words : {"Parameters", "joint2.beta", "E.x", "held out", "chi-square",
                            "Every direction in the space", "Calibrated model: "}) {
    CAPTURE(words);
    CHECK(contains(run.out, words));
  }
  REQUIRE(folder.files().size() == 2);
  const std::string calibrated = folder / "model-calibrated.xml";
  const Program before = program_of(arm), after = program_of(calibrated);
  REQUIRE(after.parameters.size() == before.parameters.size());
  for (std::size_t i = 0; i < after.parameters.size(); ++i) {
    CHECK(after.parameters[i].name == before.parameters[i].name);
    CHECK(*after.parameters[i].nominal.tolerance < *before.parameters[i].nominal.tolerance);
  }
  const Run again = command(folder, "calibrate model-calibrated.xml poses.csv --out again");
  CHECK(again.code == 0);
  CHECK(std::filesystem::exists(folder / "again/model-calibrated-calibrated.xml"));
}

TEST_CASE("a model in Lua is calibrated to a model in Lua") {
  const RecordedFolder folder;
  const Run run = command(folder, "calibrate '" + shipped("arm-6r/model.lua") + "' poses.csv");
  CHECK(run.code == 0);
  CHECK(program_of(folder / "model-calibrated.lua").parameters.size() == 27);
}

TEST_CASE("exit codes: 0 done, 1 not converged, 2 bad input or usage") {
  const RecordedFolder folder;
  CHECK(command(folder, "--help").code == 0);
  CHECK(command(folder, "--version").code == 0);
  CHECK(command(folder, "check '" + arm + "'").code == 0);
  CHECK(command(folder, "calibrate '" + arm + "' poses.csv --iterations 1 --restarts 0").code == 1);
  for (const char* arguments : {"", "calibrat", "calibrate", "calibrate nowhere.xml poses.csv",
                                "check poses.csv", "plugins dhh", "convert poses.csv out.xml"}) {
    CAPTURE(arguments);
    const Run run = command(folder, arguments);
    CHECK(run.code == 2);
    CHECK(!run.error.empty());
    CHECK(run.out.empty());
  }
  for (const char* arguments : {"nowhere.csv", "poses.csv --check 2", "poses.csv --solver best",
                                "poses.csv --set joint9.a=3", "poses.csv --set joint2.alhpa=3",
                                "poses.csv --set residual", "poses.csv --plugin no.lua"}) {
    CAPTURE(arguments);
    CHECK(command(folder, "calibrate '" + arm + "' " + arguments).code == 2);
  }
}

TEST_CASE("after bad input nothing is written") {
  const RecordedFolder folder;
  folder.write("short.csv", "pose,theta1[deg]\n1,3\n2,4\n");
  folder.write("broken.csv", "pose,theta1[deg]\n1,three\n");
  folder.write("broken.xml",
               "<talus>\n  <chain from=\"B\" to=\"E\"><dhh name=\"j\"/></chain>\n</talus>\n");
  const auto before = folder.files().size();
  const Run missing =
      command(folder, "calibrate '" + arm + "' short.csv --out results --json r.json");
  CHECK(missing.code == 2);
  CHECK(contains(missing.error, "theta2"));
  const Run broken = command(folder, "calibrate '" + arm + "' broken.csv --out results");
  CHECK(broken.code == 2);
  CHECK(contains(broken.error, "broken.csv:2:3"));
  const Run model = command(folder, "calibrate broken.xml poses.csv --out results");
  CHECK(model.code == 2);
  CHECK(contains(model.error, "broken.xml:2:"));
  CHECK(contains(model.error, "did you mean 'dh'?"));
  CHECK(folder.files().size() == before);
}

TEST_CASE("--json - is the report as JSON, with every key that was promised") {
  const RecordedFolder folder(shipped("isl-bonny-2013/published.xml"), 65);
  const Run run = command(folder, "calibrate '" + shipped("isl-bonny-2013/model.xml") +
                                      "' poses.csv --json - --check 0.2");
  CAPTURE(run.error);
  REQUIRE(run.code == 0);
  const json report = json::parse(run.out);
  CHECK(report["command"] == "calibrate");
  for (const char* key : {"talus", "model", "recordings", "poses", "baseline"}) {
    CAPTURE(key);
    CHECK(report.contains(key));
  }
  CHECK(report["poses"]["fit"] == 52);
  CHECK(report["poses"]["check"] == 13);
  const json& baseline = report["baseline"];
  for (const char* key : {"fit_rms", "heldout_rms", "chi2_dof", "measures", "measures_fit",
                          "parameters", "unidentifiable", "iterations", "seconds", "stopped"}) {
    CAPTURE(key);
    CHECK(baseline.contains(key));
  }
  REQUIRE(baseline["measures"].size() == 6);
  for (const char* key : {"name", "unit", "bias", "precision", "rmse", "fsr", "percent_fsr"}) {
    CAPTURE(key);
    CHECK(baseline["measures"][3].contains(key));
    CHECK(baseline["measures_fit"][3].contains(key));
  }
  CHECK(baseline["measures"][0]["name"] == "E.x");
  CHECK(baseline["measures"][0]["unit"] == "mm");
  CHECK(baseline["measures"][3]["name"] == "E.PAx");
  CHECK(baseline["measures"][3]["unit"] == "deg");
  REQUIRE(baseline["parameters"].size() == 38);
  for (const char* key : {"name", "unit", "nominal", "value", "std", "identifiable"}) {
    CAPTURE(key);
    CHECK(baseline["parameters"][0].contains(key));
  }
  CHECK(baseline["unidentifiable"].size() == 2);
  CHECK(baseline["unidentifiable"][0].is_string());
  CHECK(baseline["fit_rms"].get<double>() < 1.2);
  CHECK(baseline["heldout_rms"].get<double>() < 1.5);
}

TEST_CASE("--json FILE and --quiet") {
  const RecordedFolder folder;
  const Run run =
      command(folder, "calibrate '" + arm + "' poses.csv --quiet --json report.json --out .");
  CHECK(run.code == 0);
  CHECK(run.out.empty());
  CHECK(json::parse(contents(folder / "report.json"))["poses"]["fit"].get<int>() == 42);
}

TEST_CASE("--set changes an input, a residual or a parameter") {
  const RecordedFolder folder(shipped("isl-bonny-2013/model.xml"));
  const std::string isl =
      "calibrate '" + shipped("isl-bonny-2013/model.xml") + "' poses.csv --json - ";
  auto report = [&](const std::string& arguments) {
    const Run run = command(folder, isl + arguments);
    CAPTURE(run.error);
    REQUIRE(run.code == 0);
    return json::parse(run.out)["baseline"];
  };
  const json swapped = report("--set residual=\"position, rotation_vector\"");
  CHECK(swapped["measures"][3]["name"] == "E.rx");
  CHECK(report("--set calibrate.residual=position")["measures"].size() == 3);
  CHECK(report("--set joint2.a=0 --set joint2.d=\"300 ?\"")["parameters"].size() == 37);
  const Run bad = command(folder, isl + "--set residual=positon");
  CHECK(bad.code == 2);
  CHECK(contains(bad.error, "did you mean 'position'?"));
}

TEST_CASE("--plugin brings a joint in Lua") {
  const Folder folder;
  folder.write("nod.lua", R"lua(
joint "nod" { theta = coordinate(angle), reach = length(0),
  transform = function(p) return rotate_y(p.theta) * translate_x(p.reach) end }
)lua");
  folder.write("model.xml", R"(<talus>
  <chain from="B" to="E"><nod name="j" theta="q" reach="100 ± 5"/></chain>
  <encoder name="q" intercept="0 ± 1"/>
  <point name="E" in="B" sigma="0.1"/>
</talus>)");
  const Run without = command(folder, "check model.xml");
  CHECK(without.code == 2);
  CHECK(contains(without.error, "nod"));
  CHECK(command(folder, "simulate model.xml --plugin nod.lua --poses 40 --recordings poses.csv")
            .code == 0);
  const Run with = command(folder, "calibrate model.xml poses.csv --plugin nod.lua");
  CAPTURE(with.error);
  CHECK(with.code == 0);
  CHECK(contains(with.out, "j.reach"));
  CHECK(contains(command(folder, "plugins nod --plugin nod.lua").out, "nod.lua"));
}

TEST_CASE("what is registered is told as JSON, with all that a script needs to write an effect") {
  const Folder folder;
  auto plugin = [&](const std::string& name) {
    const Run run = command(folder, "plugins " + name + " --json -");
    REQUIRE(run.code == 0);
    const json all = json::parse(run.out).at("plugins");
    REQUIRE(all.size() == 1);
    return all[0];
  };
  const json coupled = plugin("coupled_motion");
  CHECK(coupled.at("acts") == "axis");
  CHECK(coupled.at("forms") == json::parse(R"([{"amounts": ["ratio"], "driven": "other"},
                        {"amounts": ["lead"], "driven": "any"}])"));
  const json wobble = plugin("axis_tilt_wobble");
  CHECK(wobble.at("inputs")[0].at("typical").get<double>() == doctest::Approx(0.05));
  CHECK(wobble.at("inputs")[0].at("unit") == "deg");
  const json play = plugin("backlash");  // of a reading in deg, or in mm
  CHECK(play.at("inputs")[0].at("unit") == "deg");
  CHECK(play.at("inputs")[0].at("length").at("unit") == "mm");
  CHECK(plugin("encoder").at("reading") == "deg");
  const Run all = command(folder, "plugins --json all.json");
  CHECK(all.code == 0);
  CHECK(all.out.empty());
  CHECK(command(folder, "plugins dhh --json -").code == 2);
}

TEST_CASE("the output does not depend on the number of threads") {
  const RecordedFolder folder(shipped("ankle-storey-2006/model.xml"), 900);
  auto report = [&](const char* threads) {
    const Run run = command(folder, "calibrate '" + shipped("ankle-storey-2006/model.xml") +
                                        "' poses.csv --json - --seed 3 --threads " + threads);
    REQUIRE(run.code == 0);
    json result = json::parse(run.out);
    result["baseline"].erase("seconds");
    return std::pair(result.dump(), contents(folder / "model-calibrated.xml"));
  };
  const auto one = report("1"), two = report("2");
  CHECK(one.first == two.first);
  CHECK(one.second == two.second);
}

TEST_CASE(
    "simulate: the seed decides, a grid is every combination, inverse kinematics reach poses") {
  const Folder folder;
  auto simulated = [&](const std::string& arguments) {
    const Run run = command(folder, "simulate '" + arm + "' " + arguments);
    CAPTURE(run.error);
    CHECK(run.code == 0);
    return run.out;
  };
  CHECK(simulated("--poses 5 --seed 4") == simulated("--poses 5 --seed 4"));
  CHECK(simulated("--poses 5 --seed 4") != simulated("--poses 5 --seed 5"));
  const auto lines = [](const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
  };
  CHECK(lines(simulated("--grid 'encoder1=-20:20:10; encoder2=0,30,60'")) == 2 + 15);

  // The 65 settings of the linkage: the fixture gives the poses, the linkage its readings.
  Run run = command(folder, "simulate '" + shipped("isl-bonny-2013/fixture.xml") +
                                "' --grid 'rotation=-20:20:10; flexion=0:120:10' --noise 0 "
                                "--recordings settings.csv");
  CHECK(run.code == 0);
  run = command(folder, "simulate '" + shipped("isl-bonny-2013/published.xml") +
                            "' --poses settings.csv --noise 0 --recordings poses.csv");
  CAPTURE(run.error);
  REQUIRE(run.code == 0);
  const Recordings wanted = read_recordings(folder / "settings.csv"),
                   reached = read_recordings(folder / "poses.csv");
  REQUIRE(reached.rows() == 65);
  for (const char* name : {"E.x", "E.y", "E.z", "E.qw", "E.qx"})
    for (int k = 0; k < 65; ++k)
      CHECK(std::abs(reached.find(name)->values[k] - wanted.find(name)->values[k]) < 1e-6);
}
