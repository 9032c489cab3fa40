// What adding a joint type costs: one short file, in C++ (adding_a_joint/runout.cpp) or in Lua
// (runout.lua), with nothing else edited. Both say the same joint,
//     T_A_B = Tz(runout cos(theta - phase)) Rz(theta).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "framework/dsl/dsl.h"
#include "framework/kinematics/program.h"
#include "tests/support/plugin_check.h"

using namespace talus;
namespace fs = std::filesystem;

static const fs::path source = TALUS_SOURCE_DIR;
static const fs::path folder = source / "tests/plugins/adding_a_joint";

static std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  REQUIRE_MESSAGE(in, file.string());
  return (std::ostringstream() << in.rdbuf()).str();
}

static auto lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

static Registry with_runout() {
  Registry registry = Registry::built_in();
  registry.load_library(TALUS_BINARY_DIR "/tests/runout.so");
  load_plugin((folder / "runout.lua").string(), registry);
  return registry;
}

static std::string xml(const std::string& joint) {
  return R"(<talus name="shaft" length="mm" angle="deg">
    <chain from="base" to="tip">)" +
         joint + R"(</chain>
    <encoder name="encoder1"/>
    <frame name="tip" in="base" sigma="0.01 mm, 0.01 deg"/>
    <calibrate residual="position" of="tip"/>
  </talus>)";
}

static std::string lua(const std::string& joint) {
  return R"(return talus { name = "shaft", length = "mm", angle = "deg",
    chain { from = "base", to = "tip", )" +
         joint + R"( },
    encoder { name = "encoder1" },
    frame { name = "tip", in_ = "base", sigma = "0.01 mm, 0.01 deg" },
    calibrate { residual = "position", of = "tip" } })";
}

TEST_CASE("a joint is one short file, known to no other") {
  CHECK(lines(contents(folder / "runout.cpp")) <= 40);
  CHECK(lines(contents(folder / "runout.lua")) <= 20);
  CHECK(contents(source / "CMakeLists.txt").find("runout") == std::string::npos);
  for (const char* room : {"framework", "plugins", "cmake"})
    for (const auto& entry : fs::recursive_directory_iterator(source / room))
      if (entry.is_regular_file() && entry.path().extension() != ".md") {
        INFO(entry.path().string());
        CHECK(contents(entry.path()).find("\"runout\"") == std::string::npos);
      }
}

TEST_CASE("the joint is named in XML and in Lua, with units, and moves as it should") {
  Registry registry = with_runout();
  for (const std::string tag : {"runout", "runout_lua"}) {
    CAPTURE(tag);
    const Model model =
        read_xml(xml("<" + tag + R"( name="joint1" theta="encoder1" runout="200 um" phase="30"/>)"),
                 "a.xml", registry);
    const Model twin = read_lua(
        lua(tag + R"( { name = "joint1", theta = "encoder1", runout = "200 um", phase = 30 })"),
        "a.lua", registry);
    CHECK(same(model.root, twin.root));

    const Program program = compile(model, registry);
    REQUIRE(program.readings.size() == 1);
    std::vector<double> slots(program.slots);
    const Rigid<Expr> T_base_tip =
        program.between(program.frame_index.at("base"), program.frame_index.at("tip"));
    auto value = [&](const Expr& e) {
      return program.tape->evaluate(e.node_on(*program.tape), slots);
    };
    for (const double theta : {-2.0, 0.0, 30 * deg, 1.0}) {
      slots[program.readings[0].slot] = theta;
      const Expr z = T_base_tip.translation(2);
      CHECK(value(z) == doctest::Approx(0.2 * std::cos(theta - 30 * deg)).epsilon(1e-14));
      CHECK(value(T_base_tip.rotation(1, 0)) == doctest::Approx(std::sin(theta)).epsilon(1e-14));
      auto derivatives = gradient(z);
      const double slope = value(derivatives[program.readings[0].slot]);
      CHECK(slope == doctest::Approx(-0.2 * std::sin(theta - 30 * deg)).epsilon(1e-14));
    }
  }
}

TEST_CASE("the joint passes the test that every plugin falls under") {
  const Registry registry = with_runout();
  for (const char* tag : {"runout", "runout_lua"}) testing::check_plugin(*registry.find(tag));
}

TEST_CASE("a model brings the joint's Lua file along") {
  Registry registry = Registry::built_in();
  std::string text = xml(R"(<runout_lua name="joint1" theta="encoder1"/>)");
  text.insert(text.find("<chain"), R"(<plugin file="runout.lua"/>)");
  read_xml(text, (folder / "shaft.xml").string(), registry);
  CHECK(registry.find("runout_lua", Family::joint));
  CHECK(!Registry::built_in().find("runout_lua"));
}

TEST_CASE("the joint's words are checked like those of any other") {
  Registry registry = with_runout();
  for (const std::string tag : {"runout", "runout_lua"}) {
    CAPTURE(tag);
    auto refusal = [&](const std::string& attributes) -> std::string {
      try {
        compile(
            read_xml(xml("<" + tag + " name=\"joint1\" " + attributes + "/>"), "a.xml", registry),
            registry);
      } catch (const InputError& error) {
        return error.what();
      }
      return "";
    };
    CHECK(refusal(R"(theta="encoder1")") == "");
    CHECK(refusal(R"(theta="encoder1" phaze="30")").find("did you mean 'phase'?") !=
          std::string::npos);
    CHECK(refusal(R"(theta="encoder1" runout="30 deg")").find("length") != std::string::npos);
    CHECK(refusal(R"(phase="30")").find("theta") != std::string::npos);
  }
}
