// What a diagnosis is told as.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "framework/report/diagnosis_report.h"
#include "tests/support/diagnosed.h"

using namespace talus;
using namespace talus::testing;
using nlohmann::json;

namespace {

const Diagnosed& eccentric() {
  static const Diagnosed d =
      diagnosed(shipped("isl-bonny-2013/model.xml"),
                isl_recordings("<encoder_eccentricity at='encoder1' sine='1' cosine='1'/>"),
                {"encoder_eccentricity", "backlash"});
  return d;
}
const ReportContext context{"diagnose", "model.xml", "recordings.csv"};

}  // namespace

TEST_CASE("the text says the verdict first, then the evidence, then what to do") {
  const Diagnosed& d = eccentric();
  const std::string text =
      diagnosis_text(d.diagnosis, d.advice, context, {"model-extended.xml", "next.csv"});
  CAPTURE(text);
  CHECK(text.starts_with("EXPLAINED. The model left out encoder eccentricity at encoder1"));
  std::size_t at = 0;
  for (const char* part :
       {"\nEvidence (", "held out)", "took no part, residuals fall from", "E.x", "What is left",
        "\nFinding. At encoder1: encoder eccentricity (scale off its centre, once per turn",
        "amplitude", "±", " deg", "Probability", "\nCalibrated parameters", "in uncertainties",
        "\nWhat would have been seen", "\nWhat no analysis of these recordings can see\n  1. ",
        "\n  5. Twins", "\nHow to go on\n", "talus calibrate model-extended.xml recordings.csv"}) {
    CAPTURE(part);
    const std::size_t found = text.find(part, at);
    REQUIRE(found != std::string::npos);
    at = found;
  }
  std::size_t longest = 0, start = 0, lines = 0;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') longest = std::max(longest, i - start), start = i + 1, ++lines;
  CHECK(longest <= 110);
  CHECK(lines < 110);
  CHECK(text.find("before") != std::string::npos);
  CHECK(diagnosis_text(d.diagnosis, d.advice, context, {}, {true, true}).size() > text.size());
}

TEST_CASE("the JSON of a diagnosis keeps its contract") {
  const Diagnosed& d = eccentric();
  const json j = json::parse(diagnosis_json(d.diagnosis, d.advice, context, {"extended.xml", ""}));
  for (const char* key :
       {"talus",          "command",    "model",          "recordings",  "poses",    "baseline",
        "verdict",        "statement",  "findings",       "hints",       "outliers", "faults",
        "sensitivity",    "untestable", "twins",          "blind_spots", "heldout",  "after",
        "extended_model", "next_poses", "next_poses_gain"}) {
    CAPTURE(key);
    CHECK(j.contains(key));
  }
  CHECK(j["verdict"] == "explained");
  CHECK(j["blind_spots"].size() == 5);
  const json& f = j["findings"][0];
  CHECK(f["effect"] == "encoder_eccentricity");
  CHECK(f["location"] == "encoder1");
  CHECK(f["parameters"][0]["name"] == "amplitude");
  CHECK(f["parameters"][0]["value"].get<double>() == doctest::Approx(std::sqrt(2.0)).epsilon(0.3));
  for (const char* key :
       {"delta_chi2", "delta_bic", "p_value", "heldout_rms_before", "heldout_rms_after"})
    CHECK(f["evidence"][key].is_number());
  for (const char* key : {"x", "before", "after", "fitted", "count"})
    CHECK(f["curve"]["points"][0][key].is_number());
  CHECK_FALSE(j["sensitivity"].empty());
  for (const json& s : j["sensitivity"]) {
    CHECK((s["smallest_visible"].is_number() || s["smallest_visible"].is_null()));
    CHECK(s["unit"].is_string());
    CHECK(s.contains("nearest_rival"));
  }
  for (const json& pose : j["next_poses"]) {
    CHECK(pose["readings"]["encoder1"]["value"].is_number());
    CHECK(pose["readings"]["encoder1"]["unit"] == "deg");
    CHECK(pose["for"].get<std::string>().starts_with("to see "));
  }
}

TEST_CASE("values are shown with the digits that their uncertainty leaves") {
  CHECK(figure_with_std(0.12345, 0.0042) == "0.1235 ± 0.0042");
  CHECK(figure_with_std(123.45, 4.2) == "123.5 ± 4.2");
  CHECK(figure_with_std(3, std::nan("")) == "3");
}
