// Whole regions held out: which, of what a finding depends on, and how they are told.
#include "framework/diagnosis/block_covariates.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "framework/calibration/simulate.h"
#include "framework/diagnosis/stage.h"
#include "tests/support/diagnosed.h"

using namespace talus;
using namespace talus::testing;

namespace {

struct Bench {
  Model model;
  Program program, fields;
  Recordings recordings;
  Split split;
  Fit fit;
};

// A shipped model with simulated recordings, and more columns that increase with the rows.
Bench bench(const std::string& file, int poses, const std::vector<RecordedColumn>& more = {}) {
  Bench b;
  b.model = model_of(shipped(file));
  b.program = program_of(b.model);
  b.recordings = simulate(b.program, random_settings(b.program, poses, 3), {4, 1, 1});
  for (const RecordedColumn& c : more) {
    std::erase_if(b.recordings.columns,
                  [&](const RecordedColumn& old) { return old.name == c.name; });
    b.recordings.columns.push_back(c);
  }
  b.split = random_split(b.recordings, 1);
  FitOptions options;
  options.restarts = 0;
  b.fit = calibrate(b.program, b.recordings, b.split, options);
  b.fields = compile_with_fields(b.model, Registry::built_in(), [&](const std::string& column) {
    return b.recordings.find(column) != nullptr;
  });
  return b;
}

std::vector<BlockCovariate> covariates(const Bench& b, const std::string& effect,
                                       const std::string& joint, const std::string& driver = "") {
  Accepted e;
  e.suspect.plugin = Registry::built_in().find(effect, Family::effect);
  REQUIRE(e.suspect.plugin);
  e.suspect.joint = joint;
  e.way.driver = driver;
  return block_covariates({e}, b.fields, b.recordings, b.program, b.fit);
}

std::vector<std::string> names(const std::vector<BlockCovariate>& all) {
  std::vector<std::string> result;
  for (const BlockCovariate& c : all) result.push_back(c.name);
  return result;
}

RecordedColumn column(const std::string& name, const std::string& unit, int rows,
                      const std::function<double(int)>& f) {
  RecordedColumn c;
  c.name = name, c.unit = *parse_unit(unit);
  for (int k = 0; k < rows; ++k) c.values.push_back(f(k));
  return c;
}

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("regions are those of what a finding depends on") {
  const int n = 60;
  const Bench b = bench("isl-bonny-2013/model.xml", n,
                        {column("time", "s", n, [](int k) { return 100.0 * k; }),
                         column("temperature", "degC", n, [](int k) { return 20 + 0.1 * k; })});
  CHECK(names(covariates(b, "encoder_eccentricity", "joint3")) == Names{"theta3"});
  CHECK(names(covariates(b, "coupled_motion", "joint3", "joint5")) == Names{"theta3", "theta5"});
  CHECK(names(covariates(b, "thermal_expansion", "")) == Names{"temperature"});
  CHECK(names(covariates(b, "reading_drift", "joint2")) == Names{"theta2", "time"});
  CHECK(names(covariates(b, "encoder_zero_slip", "joint2")) == Names{"theta2", "time"});
}

TEST_CASE("unknowns of a pose are regions as well, where a joint is made of them") {
  const Bench b = bench("ankle-storey-2006/model.xml", 60);
  const std::vector<BlockCovariate> c = covariates(b, "axis_migration", "subtalar", "talocrural");
  REQUIRE(names(c) == Names{"q2", "q1"});
  const auto [low, high] = std::minmax_element(c[0].values.begin(), c[0].values.end());
  CHECK(*high - *low > 5 * deg);
  CHECK(c[0].unit == "deg");
  for (const double v : c[0].values) CHECK(std::isfinite(v));  // fitted and held out
}

TEST_CASE("ends of a circumstance are held out, levels and the last session whole") {
  const int n = 90;
  const Bench b = bench("isl-bonny-2013/model.xml", n,
                        {column("session", "1", n, [](int k) { return k < 60 ? 1.0 : 2.0; })});
  const BlockModel model{&b.program, b.fit.x};
  FitOptions options;
  const BlockCovariate time{"time", "s", 1,
                            column("t", "s", n, [](int k) { return 1.0 * k; }).values},
      load{"payload", "kg", 1,
           column("p", "kg", n, [](int k) { return k % 3 == 0 ? 2.0 : 0.5; }).values},
      same{"temperature", "degC", 1, std::vector<double>(n, 20)};
  const std::vector<Block> blocks =
      held_out_blocks(model, model, b.recordings, b.split, {time, load, same}, options);
  std::vector<std::string> told;
  for (const Block& block : blocks) {
    told.push_back(block.name);
    CHECK(block.before == doctest::Approx(block.after));  // the same model
    CHECK(block.before > 0.8);
    CHECK(block.before < 1.5);
  }
  REQUIRE(told.size() == 4);
  CHECK(told[0].starts_with("time below "));
  CHECK(told[1].starts_with("time above "));
  for (const std::size_t i : {0, 1}) {  // a sixth of the rows, about
    CHECK(blocks[i].poses > 8);
    CHECK(blocks[i].poses < 25);
  }
  CHECK(told[2] == "payload at 2 kg");  // without the others too few would be left
  CHECK(blocks[2].poses == 30);
  CHECK(told[3] == "session 2");
  CHECK(blocks[3].poses == 30);
}
