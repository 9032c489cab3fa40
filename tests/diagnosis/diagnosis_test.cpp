// Whole diagnoses: of recordings made by others, where they are present, and of shipped ones.
#include "framework/diagnosis/diagnosis.h"

#include <doctest/doctest.h>

#include <set>

#include "framework/dsl/dsl.h"
#include "framework/report/diagnosis_report.h"
#include "framework/report/report.h"
#include "tests/support/cases.h"

using namespace talus;
using namespace talus::testing;

namespace {

const std::string source = TALUS_SOURCE_DIR;

struct Read {
  Registry registry = Registry::built_in();
  Model model;
  Recordings recordings;
  Split split;
};

Read read(const std::string& model, const std::string& recordings) {
  Read r;
  r.model = read_model(model, r.registry);
  r.recordings = read_recordings(recordings);
  SplitOptions options;
  r.split = split_rows(r.recordings, options);
  return r;
}

Diagnosis diagnosed(const Read& r, int threads = 2) {
  DiagnosisOptions options;
  options.fit.threads = threads;
  return diagnose(r.model, r.registry, r.recordings, r.split, options);
}

const std::string isl = source + "/models/isl-bonny-2013/";

}  // namespace

TEST_CASE("an effect concealed in recordings is named, and once modelled nothing is missing") {
  Read r = read(isl + "model.xml", isl + "concealed.csv");
  const Diagnosis d = diagnosed(r);
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == "encoder_eccentricity");
  CHECK(d.findings[0].location == "encoder3");
  CHECK(d.after.heldout_rms < 1.1);
  CHECK(d.after.heldout_rms < 0.8 * d.baseline.heldout_rms);
  CHECK(d.heldout.p_value < 0.01);
  REQUIRE(d.blocks.size() == 2);  // both ends of theta3
  for (const Block& b : d.blocks) CHECK(b.after < 0.8 * b.before);
  // 0.25 and -0.15 deg.
  const Accepted& e = d.findings[0].accepted;
  REQUIRE(e.amounts.size() == 2);
  CHECK(std::abs(e.amounts[0] - 0.25 * deg) < 4 * e.std[0]);
  CHECK(std::abs(e.amounts[1] + 0.15 * deg) < 4 * e.std[1]);

  r.model = calibrated_model(d.extended_model, *d.program_after, d.after);
  const Diagnosis again = diagnosed(r);
  CHECK(again.verdict == Verdict::nothing_missing);
  CHECK(again.findings.empty());
}

TEST_CASE("nothing is found where nothing is missing") {
  const Diagnosis d = diagnosed(read(isl + "model.xml", isl + "recordings.csv"));
  CHECK(d.verdict == Verdict::nothing_missing);
  CHECK(d.findings.empty());
  CHECK(d.outliers.found.empty());
}

TEST_CASE("a diagnosis does not depend on the number of threads") {
  const Read r = read(isl + "model.xml", isl + "concealed.csv");
  const Diagnosis one = diagnosed(r, 1), three = diagnosed(r, 3);
  REQUIRE(one.findings.size() == three.findings.size());
  for (std::size_t i = 0; i < one.findings.size(); ++i) {
    CHECK(one.findings[i].accepted.amounts == three.findings[i].accepted.amounts);
    CHECK(one.findings[i].probability == three.findings[i].probability);
  }
  CHECK(one.after.heldout_rms == three.after.heldout_rms);
  CHECK(one.search.first.log_p == three.search.first.log_p);
}

// Recordings made by another program, with effects that their keys tell.
TEST_CASE("concealed effects of another program's recordings are found and named") {
  each_case([](const std::string&, const nlohmann::json& key, const std::string& model,
               const std::string& file) {
    const Diagnosis d = diagnosed(read(model, file));
    CHECK((to_string(d.verdict) == key["expected_verdict"] ||
           (key["expected_verdict"] == "ambiguous" && d.verdict == Verdict::explained)));
    std::set<std::string> wanted, found;
    bool unknown = false;
    for (const auto& e : key["effects"]) {
      if (e["id"] == "gross_outliers") {
        std::set<int> rows, seen;
        for (const auto& row : e["parameters"]["rows"]["value"]) rows.insert(row.get<int>());
        for (const Outlier& o : d.outliers.found) seen.insert(o.pose);
        CHECK(rows == seen);
        continue;
      }
      if (key["absorbed"].get<bool>()) continue;
      unknown |= e["id"] == "off_catalogue";
      wanted.insert((e["id"] == "off_catalogue" ? "unknown" : e["id"].get<std::string>()) + "@" +
                    e["location"].get<std::string>());
    }
    for (const Finding& f : d.findings) found.insert(f.effect + "@" + f.location);
    CHECK(wanted == found);
    if (wanted.empty()) return;
    // As near to the floor as 95 % of what could be gained.
    const double floor = key["floor_check_rms"], rigid = key["rigid_check_rms"];
    CHECK(d.after.heldout_rms <= floor + 0.05 * (rigid - floor));
  });
}
