#include "framework/play/session.h"

#include <doctest/doctest.h>

#include "framework/calibration/circumstances.h"
#include "framework/calibration/fit.h"
#include "framework/calibration/split_options.h"
#include "framework/dsl/dsl.h"
#include "framework/kinematics/posture.h"
#include "tests/support/command.h"

using namespace talus;
using Json = nlohmann::ordered_json;

namespace {

const std::string lessons = TALUS_SOURCE_DIR "/docs/lessons/";

struct Asked {
  PlaySession session;
  Json operator()(const Json& request) { return Json::parse(session.answer(request.dump())); }
  Json read(const std::string& file) {
    return (*this)({{"do", "read"}, {"text", testing::contents(file)}, {"file", file}});
  }
};

}  // namespace

TEST_CASE("a session shows frames where the library has them") {
  Asked ask;
  const std::string file = lessons + "dh.xml";
  const Json read = ask.read(file);
  REQUIRE_FALSE(read.contains("error"));
  Registry registry = Registry::built_in();
  const Program program = compile(read_model(file, registry), registry);
  Posture posture(program);
  posture.set(std::vector<double>{30 * deg, -40 * deg});
  const Json values = ask({{"do", "pose"}, {"coordinates", {30, -40}}})["values"];
  REQUIRE(read["scene"]["frames"].size() == program.frames.size());
  for (std::size_t f = 0; f < program.frames.size(); ++f) {
    const int at = read["scene"]["frames"][f]["at"];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j)
        CHECK(values[at + 4 * i + j].get<double>() ==
              doctest::Approx(posture.frame(static_cast<int>(f)).matrix()(i, j)).epsilon(1e-12));
  }
  CHECK(read["parameters"].size() == 6);
  CHECK(read["parameters"][0]["name"] == "joint1.d");
}

TEST_CASE("a session says where a model is wrong, and goes on") {
  Asked ask;
  Json answer = ask({{"do", "read"},
                     {"text", "<talus name=\"x\">\n <chian from=\"a\" to=\"b\"/>\n</talus>"},
                     {"file", "m.xml"}});
  REQUIRE(answer.contains("error"));
  CHECK(answer["error"]["line"] == 2);
  CHECK(answer["error"]["text"].get<std::string>().find("chain") != std::string::npos);
  CHECK(answer["error"]["text"].get<std::string>().find("m.xml") == std::string::npos);
  CHECK(ask({{"do", "pose"}, {"coordinates", {1}}}).contains("error"));  // no model
  CHECK(ask({{"do", "dance"}}).contains("error"));
  CHECK(Json::parse(ask.session.answer("not json")).contains("error"));
  CHECK_FALSE(ask.read(lessons + "encoder.xml").contains("error"));
  CHECK(ask({{"do", "residuals"}}).contains("error"));  // no recordings
}

TEST_CASE("a planted fault is in the recordings and not in the model") {
  Asked ask;
  ask.read(lessons + "encoder.xml");
  auto left = [&](const std::string& faults) {
    const Json simulated =
        ask({{"do", "simulate"}, {"faults", faults}, {"poses", 40}, {"seed", 3}});
    REQUIRE_FALSE(simulated.contains("error"));
    CHECK(ask({{"do", "record"}, {"text", simulated["recordings"]}})["poses"] == 40);
    return ask({{"do", "residuals"}})["rms"].get<double>();
  };
  CHECK(left("") == doctest::Approx(1).epsilon(0.3));
  // Beside noise of 1, which 40 poses hold to a tenth; twice the fault has four times the square.
  auto eccentric = [&](const std::string& cosine) {
    const double rms =
        left("<talus><encoder_eccentricity at=\"encoder3\" cosine=\"" + cosine + "\"/></talus>");
    return rms * rms - 1;
  };
  const double once = eccentric("0.1");
  CHECK(once > 3);
  CHECK(eccentric("0.2") / once == doctest::Approx(4).epsilon(0.1));
  CHECK(left("<talus><dh name=\"shoulder\" a=\"301\"/></talus>") >
        5);  // of an element that is there
  CHECK(ask({{"do", "simulate"}, {"faults", "<talus><no_such/></talus>"}}).contains("error"));
}

TEST_CASE("a session calibrates as the library does") {
  Asked ask;
  const std::string file = lessons + "encoder.xml";
  ask.read(file);
  const std::string text = ask({{"do", "simulate"},
                                {"faults", "<talus><dh name=\"elbow\" a=\"250.8\"/></talus>"},
                                {"poses", 40}})["recordings"];
  ask({{"do", "record"}, {"text", text}});
  const Json fit = ask({{"do", "calibrate"}, {"seed", 2}});
  REQUIRE_FALSE(fit.contains("error"));
  Registry registry = Registry::built_in();
  const Program program = compile(read_model(file, registry), registry);
  const Recordings recordings = with_derived(program, parse_recordings(text, "x.csv"));
  FitOptions options;
  options.seed = 2;
  const Fit expected =
      calibrate(program, recordings,
                split_rows(recordings, split_options(program, recordings, 0.3, {}, 2)), options);
  CHECK(fit["heldout_rms"].get<double>() == doctest::Approx(expected.heldout_rms));
  REQUIRE(fit["parameters"].size() == expected.parameters.size());
  for (std::size_t i = 0; i < expected.parameters.size(); ++i) {
    const FittedValue& p = expected.parameters[i];
    CHECK(fit["parameters"][i]["value"].get<double>() * program.units.of(p.dimension).factor ==
          doctest::Approx(p.value));
  }
  CHECK(fit["state"]["rows"].size() == 3);
  // The calibrated model is a model again.
  const Json again = ask({{"do", "read"}, {"text", fit["model"]}, {"file", "calibrated.xml"}});
  CHECK_FALSE(again.contains("error"));
}

TEST_CASE("play says in one line how to get the page, or writes it") {
  const testing::Folder folder;
  const testing::Run run = testing::command(folder, "play '" + lessons + "ankle.xml' --out p.html");
  if (run.code == 2) {
    CHECK(run.error.find("scripts/build page") != std::string::npos);
    CHECK(folder.files().empty());
    return;
  }
  REQUIRE(run.code == 0);
  const std::string page = testing::contents(folder / "p.html");
  CHECK(page.size() < 6'000'000);
  CHECK(page.find("\"file\":\"ankle.xml\"") != std::string::npos);
  CHECK(page.find("id=\"given\">null") == std::string::npos);
}
