// talus motion: tables of coordinates and frames, as users run it.
#include "framework/report/motion.h"

#include "framework/kinematics/pose_values.h"
#include "tests/support/command.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

namespace {

const std::string ankle = "'" + shipped("ankle-storey-2006/model.xml") + "'";
const std::string isl = "'" + shipped("isl-bonny-2013/published.xml") + "'";

Run motion(const Folder& folder, const std::string& arguments) {
  return command(folder, "motion " + arguments);
}

Recordings table(const Folder& folder, const std::string& arguments) {
  const Run run = motion(folder, arguments + " --table motion.csv");
  CAPTURE(run.error);
  REQUIRE(run.code == 0);
  return read_recordings(folder / "motion.csv");
}

std::vector<std::string> names(const Recordings& table) {
  std::vector<std::string> result;
  for (const RecordedColumn& c : table.columns) result.push_back(c.name);
  return result;
}

}  // namespace

TEST_CASE("a motion table is a recording: what it shows is what simulate measures") {
  const Folder folder;
  REQUIRE(
      command(folder, "simulate " + isl + " --poses 20 --noise 0 --recordings poses.csv").code ==
      0);
  const Recordings poses = read_recordings(folder / "poses.csv"),
                   moved = table(folder, isl + " poses.csv");
  REQUIRE(names(moved) == names(poses));
  for (std::size_t c = 0; c < poses.columns.size(); ++c)
    for (std::size_t k = 0; k < 20; ++k)
      CHECK(moved.columns[c].values[k] ==
            doctest::Approx(poses.columns[c].values[k]).epsilon(1e-12));
  // And from the frames alone, by inverse kinematics.
  Recordings frames = poses;
  std::erase_if(frames.columns,
                [](const RecordedColumn& c) { return c.name.starts_with("theta"); });
  folder.write("frames.csv", write_recordings(frames));
  const Run run = motion(folder, isl + " frames.csv");
  CHECK(run.out.find("# found from the measured features of frames.csv: encoder1, encoder2") !=
        std::string::npos);
  REQUIRE(command(folder, "calibrate " + isl + " motion.csv --quiet --out .").code <= 1);
}

TEST_CASE("latent angles are found from measured frames and head the table") {
  const Folder folder;
  REQUIRE(command(folder, "simulate " + ankle + " --poses 12 --seed 5 --recordings measured.csv")
              .code == 0);
  const Recordings drawn = table(folder, ankle + " --poses 12 --seed 5"),
                   found = table(folder, ankle + " measured.csv");
  for (const char* q : {"q1", "q2"})
    for (std::size_t k = 0; k < 12; ++k)
      CHECK(std::abs(found.find(q)->values[k] - drawn.find(q)->values[k]) < 2 * deg);
  CHECK(names(found) == std::vector<std::string>{"pose", "q1", "q2", "E.x", "E.y", "E.z", "E.qw",
                                                 "E.qx", "E.qy", "E.qz"});
}

TEST_CASE("--angles: ordered rotations, named or not") {
  const Folder folder;
  const Recordings named =
      table(folder, ankle +
                        " --grid 'q1=-170:170:20; q2=0,100' --angles 'flexion=z, internal=x, "
                        "inversion=y'");
  CHECK(names(named) == std::vector<std::string>{"pose", "q1", "q2", "E.x", "E.y", "E.z",
                                                 "E.flexion", "E.internal", "E.inversion"});
  CHECK(named.find("E.flexion")->unit.text == "deg");
  Program program = program_of(shipped("ankle-storey-2006/model.xml"));
  PoseValues pose(program, program.between(0, program.frame("E", {})));
  for (std::size_t k = 0; k < named.rows(); ++k) {
    auto of = [&](const char* name) { return named.find(name)->values[k]; };
    const auto R = pose(slots_at(program, std::vector{of("q1"), of("q2")})).rotation;
    const Matrix3<double> composed =
        (rotate_z(of("E.flexion")) * rotate_x(of("E.internal")) * rotate_y(of("E.inversion")))
            .rotation();
    for (int i = 0; i < 9; ++i) CHECK(std::abs(R[i / 3][i % 3] - composed[i / 3][i % 3]) < 1e-12);
  }
  const Recordings plain = table(folder, ankle + " --grid 'q1=10' --angles zxy"),
                   euler = table(folder, ankle + " --grid 'q1=10' --angles zxz");
  CHECK(names(plain).back() == "E.ry");
  CHECK(plain.find("E.rz")->values[0] ==
        doctest::Approx(table(folder, ankle + " --grid 'q1=10' --angles 'a=z, b=x, c=y'")
                            .find("E.a")
                            ->values[0]));
  CHECK(euler.find("E.rz1"));
  CHECK(euler.find("E.rz2"));
}

TEST_CASE("--frame and --of --in choose the frames") {
  const Folder folder;
  const std::string at = " --grid 'q1=20; q2=-30'";
  const Recordings one = table(folder, ankle + at + " --of talocrural"),
                   two = table(folder, ankle + at +
                                           " --frame 'subtalar in talocrural' --frame subtalar "
                                           "--frame 'E in B' --frame 'B in E'");
  CHECK(one.find("talocrural.qw"));
  CHECK(!one.find("E.x"));
  for (const char* column : {"subtalar.x", "subtalar_in_B.x", "E.x", "B.x"}) {
    CAPTURE(column);
    CHECK(two.find(column));
  }
  const Recordings seen = table(folder, ankle + at + " --of subtalar --in talocrural");
  CHECK(seen.find("subtalar.z")->values == two.find("subtalar.z")->values);
  // A point is shown where it is measured, with its offset from the frame.
  folder.write("point.xml",
               R"(<talus><chain from="B" to="E"><dh name="j" theta="q" a="100"/></chain>
    <encoder name="q"/><point name="tip" at="E" in="B" x="10"/></talus>)");
  CHECK(table(folder, "point.xml --grid 'q=0'").find("tip.x")->values[0] == doctest::Approx(110));
}

TEST_CASE("--limbs: the twelve points of every limb, in the root frame") {
  const Folder folder;
  const std::string limbs = "'" + shipped("limbs-storey-2006/model.xml") + "' ",
                    positions = "'" + shipped("limbs-storey-2006/positions.csv") + "'";
  const Recordings moved = table(folder, limbs + positions + " --limbs");
  REQUIRE(moved.rows() == 6);
  CHECK(moved.find("pose")->values[0] == 0);  // the recordings' own numbers
  const Program program = program_of(shipped("limbs-storey-2006/model.xml"));
  CHECK(moved.columns.size() == 3 + 2 * 7 + 36 * program.limbs.size());
  auto at = [&](const std::string& point, std::size_t k) {
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i) p[i] = moved.find(point + "." + "xyz"[i])->values[k];
    return p;
  };
  for (std::size_t k = 0; k < 6; ++k) {
    const Eigen::Vector3d centre = at("distal.centre", k), x = at("distal.end_x", k) - centre;
    CHECK((centre - at("distal", k)).norm() < 1e-12);  // its frame is at its centre
    CHECK(x.norm() == doctest::Approx(40));
    CHECK((at("distal.v1", k) + at("distal.v7", k) - 2 * centre).norm() < 1e-12);
    CHECK((at("proximal.v3", k) - Eigen::Vector3d(60, 20, -15)).norm() < 1e-12);
  }
  CHECK(motion(folder, isl + " --limbs").code == 2);
}

TEST_CASE("what motion is told off for") {
  const Folder folder;
  folder.write("other.csv", "pose,theta1[deg]\n1,3\n2,4\n");
  auto error = [&](const std::string& arguments) {
    const Run run = motion(folder, arguments);
    CHECK(run.code == 2);
    CHECK(run.out.empty());
    return said(run.error);
  };
  CHECK(error(ankle + " --frame 'E in tibai'").find("--frame E in tibai: no frame 'tibai'\n") == 0);
  CHECK(error(ankle + " --of subtalra").find("did you mean 'subtalar'?") != std::string::npos);
  CHECK(error(ankle + " --angles zxx").find("--angles zxx: 'zxx' turns about x twice running\n") ==
        0);
  CHECK(error(ankle + " --angles 'a=z, b=x'").find("'zx' is not a sequence of axes") !=
        std::string::npos);
  CHECK(error(ankle + " --angles 'a=z, b=x, a=y'").find("the name 'a' twice") != std::string::npos);
  CHECK(error(ankle + " --angles 'x=z, b=x, a=y'").find("'x' is the name of") != std::string::npos);
  CHECK(error(ankle + " --angles 'a=z, b:x, c=y'").find("'b:x'") != std::string::npos);
  CHECK(error(ankle + " other.csv").find("other.csv:1: there is no column 'q1'") == 0);
  CHECK(error(ankle + " other.csv --grid 'q1=1'").find("--grid") != std::string::npos);
  CHECK(error(ankle + " --table nowhere/motion.csv").find("there is no folder") !=
        std::string::npos);
  CHECK(folder.files() == std::vector<std::string>{"other.csv"});
}
