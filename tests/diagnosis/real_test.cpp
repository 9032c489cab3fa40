// Diagnoses of recordings of real devices, where they lie beside the repository (they are not part
// of it). Only those that take seconds; scripts/figures/real-diagnoses tries all.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>

#include "framework/diagnosis/diagnosis.h"
#include "tests/support/fits.h"

using namespace talus;
using namespace talus::testing;

namespace {

const std::string data = TALUS_SOURCE_DIR "/../shared/data/";

bool there(const std::string& file) {
  if (std::filesystem::exists(data + file)) return true;
  MESSAGE("skipped, not beside the repository: ", file);
  return false;
}

Diagnosis diagnosed(const std::string& model_file, const std::string& file,
                    const std::string& group, const std::vector<std::string>& only = {}) {
  Registry registry = Registry::built_in();
  const Model model = read_model(shipped(model_file), registry);
  const Recordings recordings = read_recordings(data + file);
  SplitOptions split;
  split.group_columns = {{group}};
  DiagnosisOptions options;
  options.fit.threads = 2;
  options.search.suspects.only = only;
  return diagnose(model, registry, recordings, split_rows(recordings, split), options);
}

double arcsec(const Diagnosis& d) {
  double sum = 0;
  for (const Measure& m : d.after.measures_check) sum += m.rmse * m.rmse;
  return std::sqrt(sum) / deg * 3600;
}

}  // namespace

TEST_CASE("a telescope mount with nothing missing is left alone, the flexure of another is seen") {
  const std::string mount = "mount-altaz/model.xml", runs = "mmt-telescope-pointing/";
  if (!there(runs + "2023-07-02.csv") || !there(runs + "2021-08-21.csv")) return;
  const Diagnosis quiet = diagnosed(mount, runs + "2023-07-02.csv", "star");
  CHECK(quiet.verdict == Verdict::nothing_missing);
  CHECK(quiet.findings.empty());

  // 4.1 and 1.04 arcsec by a linear model of flexure and the cotangent of the elevation.
  const Diagnosis bent = diagnosed(mount, runs + "2021-08-21.csv", "star",
                                   {"joint_compliance", "atmospheric_refraction"});
  CHECK(arcsec(bent) <= 1.05);
  REQUIRE(bent.findings.size() == 2);
  CHECK(bent.findings[0].effect == "joint_compliance");
  CHECK(bent.findings[0].location == "elevation");
  CHECK(bent.findings[1].effect == "atmospheric_refraction");
}

TEST_CASE("a ball held by hand in sockets: too little is left for a claim") {
  if (!there("mukca-panda-socket/panda_3.csv")) return;
  const Diagnosis d =
      diagnosed("arm-panda/model.xml", "mukca-panda-socket/panda_3.csv", "location");
  CHECK(d.findings.empty());
  CHECK(d.verdict != Verdict::explained);
}
