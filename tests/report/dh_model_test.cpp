// A chain of hinges written anew with Denavit-Hartenberg joints moves as it did.
#include "framework/report/dh_model.h"

#include "framework/kinematics/posture.h"
#include "tests/support/command.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

namespace {

Model converted(const Model& model) { return dh_model(model, Registry::built_in()); }

// The largest difference of any measured transform at 50 random postures, relative to its size.
double farthest(const Model& model, const Model& dh) {
  const Program before = program_of(model), after = program_of(dh);
  REQUIRE(before.features.size() == after.features.size());
  Posture was(before), is(after);
  double most = 0;
  int seen = 0;
  for (const auto& pose : random_settings(before, 50, 11).poses) {
    was.set(pose);
    is.set(pose);
    for (const Feature& f : before.features) {
      // By the names that the model uses: another name of that frame may be a joint's.
      Model named = model;
      const Element& element = *named.root.find_named(f.name);
      const std::string at = element.text("at", f.name),
                        in = element.text("in", before.frames[0].name);
      const auto a = was.between(before.frame(in, {}), before.frame(at, {})),
                 b = is.between(after.frame(in, {}), after.frame(at, {}));
      if (!a.matrix().allFinite()) continue;
      ++seen;
      most = std::max(most, (a.matrix() - b.matrix()).cwiseAbs().maxCoeff());
    }
  }
  CHECK(seen >= 50);
  return most;
}

int joints_called(const Model& model, const std::string& tag) {
  int count = 0;
  for (const Element& chain : model.root.children)
    if (chain.tag == "chain")
      for (const Element& joint : chain.children) count += joint.tag == tag;
  return count;
}

std::string refused(const std::string& joints, const std::string& rest) {
  Registry registry = Registry::built_in();
  const Model model =
      read_xml("<talus>\n<chain from=\"B\" to=\"E\">\n" + joints + "\n</chain>\n" + rest +
                   "\n<encoder name=\"q1\"/><encoder name=\"q2\"/>"
                   "<frame name=\"E\" in=\"B\"/>\n</talus>",
               "model.xml", registry);
  try {
    dh_model(model, registry);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("shipped chains of hinges keep their measured frames, to 1e-9") {
  for (const auto& [file, hinges] :
       std::vector<std::pair<std::string, int>>{{"limbs-storey-2006/model.xml", 2},
                                                {"ankle-storey-2006/model.xml", 2},
                                                {"isl-bonny-2013/published.xml", 6},
                                                {"arm-ur10/model.xml", 6},
                                                {"arm-motoman/model.xml", 7},
                                                {"arm-6r/model.xml", 6},
                                                {"knee-two-axis/model.xml", 2},
                                                {"knee-two-axis/step-up.xml", 1},
                                                {"device-nordquist-2009/published.xml", 3},
                                                {"mount-altaz/model.xml", 2}}) {
    const std::string name = file;
    CAPTURE(name);
    const Model model = model_of(shipped(file)), dh = converted(model);
    CHECK(farthest(model, dh) < 1e-9);
    CHECK(joints_called(dh, "dh") == hinges);
    for (const char* other : {"storey", "revolute", "revolute_about", "dh_proximal", "dh_hayati"})
      CHECK(joints_called(dh, other) == 0);
    check_grammar(dh, Registry::built_in());
    CHECK(farthest(dh, converted(dh)) < 1e-9);  // and once more
  }
}

TEST_CASE("random chains of all kinds of hinges") {
  Random random(31);
  for (int trial = 0; trial < 20; ++trial) {
    std::string joints, sensors;
    auto put = [&](const char* name, double reach, const char* unit = "") {
      return std::string(name) + "=\"" + shortest(between(random, -reach, reach)) + unit + "\" ";
    };
    const int n = 1 + trial % 7;
    for (int k = 0; k < n; ++k) {
      const std::string name = "name=\"j" + std::to_string(k) + "\" ", q = "q" + std::to_string(k),
                        turn = k % 3 == 0   ? q
                               : k % 3 == 1 ? "-" + q + " + 20 deg"
                                            : "-(" + q + " - q0)";
      const std::string theta = "theta=\"" + turn + "\" ";
      switch (static_cast<int>(between(random, 0, 6))) {
        case 0:
          joints += "<dh " + name + theta + put("d", 90) + put("a", 90) + put("alpha", 170) + "/>";
          break;
        case 1:
          joints += "<dh_hayati " + name + theta + put("a", 90) + put("alpha", 170) +
                    put("beta", 90) + "/>";
          break;
        case 2:
          joints += "<dh_proximal " + name + theta + put("d", 90) + put("a", 90) +
                    put("alpha", 170) + "/>";
          break;
        case 3:
          joints += "<revolute " + name + theta + put("x", 90) + put("y", 90) + put("z", 90) +
                    put("roll", 170) + put("yaw", 80) + "/>";
          break;
        case 4:
          joints += "<revolute_about " + name + theta + put("x", 90) + put("y", 90) + put("z", 90) +
                    put("ux", 1) + put("uy", 1) + put("uz", 1) + "/>";
          break;
        default:
          joints += "<storey " + name + theta + put("x_fp", 90) + put("z_fp", 20) +
                    put("psi_fp", 90) + put("phi_fp", 80) + put("theta_td", 170) +
                    put("phi_td", 80) + put("y_td", 90) + "/>";
      }
      if (k % 2)
        joints +=
            "<fixed name=\"f" + std::to_string(k) + "\" " + put("x", 30) + put("b", 40) + "/>";
      sensors += "<encoder name=\"" + q + "\" slope=\"" + (k % 2 ? "-1.01" : "0.98") +
                 "\" intercept=\"" + std::to_string(15 * k) + "\" range=\"-180, 180\"/>";
    }
    CAPTURE(joints);
    Registry registry = Registry::built_in();
    const Model model =
        read_xml("<talus><chain from=\"B\" to=\"E\">" + joints + "</chain>" + sensors +
                     "<frame name=\"E\" in=\"B\"/><point name=\"P\" at=\"j0\" in=\"B\"/></talus>",
                 "model.xml", registry);
    const Model dh = converted(model);
    CHECK(farthest(model, dh) < 1e-9);
    CHECK(joints_called(dh, "dh") == n);
  }
}

TEST_CASE("masses, limbs and frames go along; radians and metres too") {
  Registry registry = Registry::built_in();
  const Model model = read_xml(R"(<talus length="m" angle="rad">
    <chain from="B" to="E">
      <revolute name="j1" theta="q1" x="0.1" roll="0.3" mass="2 kg" com="0.1, 0, 0"/>
      <fixed name="flange" x="0.2" mass="1 kg" com="0, 0.3, 0"/>
      <revolute name="j2" theta="q2" z="0.4" yaw="0.5"/>
    </chain>
    <limb name="arm" at="flange" length="0.2" width="0.05" height="0.05"/>
    <encoder name="q1"/><encoder name="q2"/>
    <point name="weight" at="j1" in="B" x="0.1"/>
    <point name="other" at="flange" in="B" y="0.3"/>
    <frame name="E" in="B"/></talus>)",
                               "model.xml", registry);
  const Model dh = converted(model);
  CHECK(farthest(model, dh) < 1e-9);
  const Program before = program_of(model), after = program_of(dh);
  REQUIRE(after.limbs.size() == 1);
  // The mass of both parts of the first body, at their common centre, in the DH joint's frame.
  Model named = dh;
  Element* joint = named.root.find_named("j1_dh");
  REQUIRE(joint);
  CHECK(joint->text("mass") == "3 kg");
  const std::string com = joint->text("com");
  Eigen::Vector3d centre;
  REQUIRE(std::sscanf(com.c_str(), "%lf, %lf, %lf", &centre[0], &centre[1], &centre[2]) == 3);
  Posture was(before), is(after);
  for (const auto& pose : random_settings(before, 5, 3).poses) {
    was.set(pose), is.set(pose);
    const Eigen::Vector3d expected =
        (2 * (was.frame(before.frame("j1", {})) * Eigen::Vector3d(100, 0, 0)) +
         was.frame(before.frame("flange", {})) * Eigen::Vector3d(0, 300, 0)) /
        3;
    CHECK((is.frame(after.frame("j1_dh", {})) * (1000 * centre) - expected).norm() < 1e-9);
    CHECK((is.frame(after.limbs[0].frame).matrix() - was.frame(before.limbs[0].frame).matrix())
              .cwiseAbs()
              .maxCoeff() < 1e-9);
  }
}

TEST_CASE("what is no chain of hinges is refused, with its place") {
  CHECK(refused(R"(<dh name="j" theta="q1"/><prismatic name="slide" d="s"/>)",
                R"(<linear name="s"/>)") ==
        "model.xml:3:26: joint 'slide' slides\n"
        "  expected joints that turn about one axis by their coordinate");
  CHECK(refused(R"(<screw name="thread" theta="q1" pitch="2 mm/deg"/>)", "")
            .find("joint 'thread' (<screw>) does not just turn about one axis") !=
        std::string::npos);
  CHECK(refused(R"(<spherical name="ball" roll="q1" pitch="q2" yaw="q1"/>)", "")
            .find("joint 'ball' moves, and <spherical> has 3 coordinates") != std::string::npos);
  CHECK(refused(R"(<mount name="plate" c="q1"/>)", "")
            .find("joint 'plate' moves, and <mount> has no coordinates") != std::string::npos);
  CHECK(
      refused(R"(<dh name="j" theta="q1"/>)",
              R"(<chain from="B" to="F"><dh name="k" theta="q2"/></chain><point name="F" in="B"/>)")
          .find("the chain branches: 'j' and 'k' both follow 'B'") != std::string::npos);
  CHECK(refused(R"(<fixed name="j" x="3"/>)", "").find("no joint that moves") != std::string::npos);
  CHECK(
      refused(
          R"(<dh name="j" theta="q1"/><revolute name="k" theta="q2" x="9" y="1" roll="0.0000001"/>)",
          "")
          .find("<dh_hayati> is for those") != std::string::npos);
}

TEST_CASE("talus convert --joints dh") {
  const Folder folder;
  const std::string limbs = "'" + shipped("limbs-storey-2006/model.xml") + "'";
  REQUIRE(command(folder, "convert " + limbs + " dh.xml --joints dh").code == 0);
  REQUIRE(command(folder, "convert " + limbs + " dh.lua --joints dh").code == 0);
  CHECK(same(model_of(folder / "dh.xml").root, model_of(folder / "dh.lua").root));
  CHECK(farthest(model_of(shipped("limbs-storey-2006/model.xml")), model_of(folder / "dh.xml")) <
        1e-9);
  CHECK(command(folder, "check dh.xml").out.find("joint1 - joint2       13.89") !=
        std::string::npos);
  const Run wrong = command(folder, "convert " + limbs + " no.xml --joints hd");
  CHECK(wrong.code == 2);
  CHECK(said(wrong.error) ==
        "--joints hd: no such conversion\n  expected dh\n  did you mean 'dh'?\n");
  const std::string tree = "'" + shipped("upper-body-justin/model.xml") + "'";
  CHECK(command(folder, "convert " + tree + " no.xml --joints dh").code == 2);
  CHECK(!std::filesystem::exists(folder / "no.xml"));
}
