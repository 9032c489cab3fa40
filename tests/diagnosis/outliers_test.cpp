// Blunders are found however they hide each other; physics that was left out is not taken for them.
#include "framework/diagnosis/outliers.h"

#include <doctest/doctest.h>

#include <set>

#include "tests/support/beds.h"

using namespace talus;
using namespace talus::testing;

namespace {

using Rows = std::set<std::size_t>;

Rows rows_of(const Outliers& outliers) {
  Rows rows;
  for (const Outlier& o : outliers.found) rows.insert(o.row);
  return rows;
}

Outliers found_in(const Simulated& s, const OutlierOptions& options = {}) {
  const Fit fit = calibrate(s.program, s.recordings, s.split, {.restarts = 0});
  return find_outliers(s.program, s.recordings, s.split, fit.x, options);
}

// The measured position of these rows shifted by about `size` mm along every axis.
Rows blunder(Recordings& recordings, Rows rows, double size) {
  Random random(7);
  for (std::size_t row : rows)
    for (const char* name : {"E.x", "E.y", "E.z"})
      column(recordings, name).values[row] +=
          size * between(random, 1, 2) * (gauss(random) < 0 ? -1 : 1);
  return rows;
}

}  // namespace

TEST_CASE("several blunders at once are found, held-out ones too, and nothing else") {
  Simulated s = simulated(arm(), 3);
  const Rows bad = blunder(s.recordings, {19, 50, 65, 94, 100, 101, 143, 147}, 0.4);
  const Outliers outliers = found_in(s);
  CHECK(rows_of(outliers) == bad);
  CHECK(outliers.scale == doctest::Approx(1).epsilon(0.15));
  for (const Outlier& o : outliers.found) {
    const bool fitted = std::count(s.split.fit.begin(), s.split.fit.end(), o.row) > 0;
    CHECK(o.held_out != fitted);
    CHECK(o.pose == static_cast<int>(o.row) + 1);
    CHECK(o.beyond > 1);
    CHECK(std::abs(o.off[0]) > 0.3);
    CHECK(std::abs(o.off[0]) < 0.9);
  }
  CHECK(outliers.found[0].statement.find("Pose 20 is off by ") == 0);
  CHECK(outliers.statement ==
        "8 of 160 poses lie far outside the others and alone: 20, 51, 66, 95, 101, 102, 144, 148.");
  CHECK(outliers.keep({18, 19, 20}) == std::vector<std::size_t>{18, 20});
  // What is returned is the fit to the others.
  Simulated clean = simulated(arm(), 3);
  clean.split.fit = outliers.keep(clean.split.fit);
  const Fit fit = calibrate(clean.program, clean.recordings, clean.split, {.restarts = 0});
  for (std::size_t i = 0; i < fit.x.size(); ++i)
    CHECK(std::abs(outliers.x[i] - fit.x[i]) < 0.1 * fit.parameters[i].std);
}

TEST_CASE("blunders that spoil the plain fit altogether") {
  Simulated s = simulated(arm(), 4);
  const Rows bad = blunder(s.recordings, {2, 3, 30, 61, 62, 63, 90, 117, 131, 150}, 300);
  CHECK(rows_of(found_in(s)) == bad);
}

// Measured on seeds that no threshold was chosen by: 3 of 400 runs had a false alarm.
TEST_CASE("good recordings have no blunders") {
  int alarms = 0;
  for (const Bed& bed : beds())
    for (std::uint64_t seed : {1, 2, 3}) {
      const Outliers outliers = found_in(simulated(bed, seed));
      alarms += !outliers.found.empty();
      CHECK(outliers.scale > 0.8);
      CHECK(outliers.scale < 1.2);
    }
  CHECK(alarms == 0);
}

TEST_CASE("physics that was left out is no blunder") {
  const Bed& bed = arm();
  for (const char* expression : {"{} + 0.2 deg*sin({})", "{} + 0.05 deg*sin(2*{})",
                                 "{} + 0.5 deg*exp(-(({} - 20 deg)/8 deg)*(({} - 20 deg)/8 deg))",
                                 "{} + 0.3 deg*(1 - 2/(exp(2*({} - 12 deg)/4 deg) + 1))"}) {
    CAPTURE(expression);
    const Outliers outliers = found_in(simulated(bed, 5, disturbed(bed, expression)));
    CHECK(outliers.found.empty());
    CHECK(outliers.scale > 3);
  }
}

TEST_CASE("a step late in the recordings is no blunder") {
  for (const Bed& bed : {beds()[0], beds()[1], beds()[2]}) {
    Simulated s = simulated(bed, 6);
    replace_rows(s.recordings, record(bed, 6, disturbed(bed, "{} + 0.3 deg")),
                 s.recordings.rows() - s.recordings.rows() / 8);
    const Outliers outliers = found_in(s);
    CHECK(outliers.found.empty());
  }
}

TEST_CASE("blunders beside physics: the large ones at once, the small ones with the right model") {
  const Bed& bed = arm();
  Simulated s = simulated(bed, 8, disturbed(bed, "{} + 0.2 deg*sin({})"));
  const Rows large = blunder(s.recordings, {10, 77, 120}, 40),
             small = blunder(s.recordings, {33, 59}, 0.5);
  CHECK(rows_of(found_in(s)) == large);
  Model model = model_of(shipped(bed.file));
  Element sine;
  sine.tag = "parameter";
  sine.set("name", "sine");
  sine.set("value", "0 ± 0.5");
  sine.set("kind", "angle");
  model.root.children.insert(model.root.children.begin(), sine);
  set(model, bed.joint, "encoder3 + sine*sin(encoder3)");
  s.program = program_of(model);
  Rows both = large;
  both.insert(small.begin(), small.end());
  CHECK(rows_of(found_in(s)) == both);
}

TEST_CASE("poses that alone were approached from the other side are no blunders") {
  Simulated s = simulated(arm(), 3);
  const Rows others = {19, 50, 94, 143};
  for (const bool recorded : {false, true}) {
    CAPTURE(recorded);
    if (recorded) {
      RecordedColumn side = s.recordings.columns[0];
      side.name = "approach_joint2", side.values.assign(s.recordings.rows(), 1);
      for (const std::size_t row : others) side.values[row] = -1;
      s.recordings.columns.push_back(side);
    } else {
      blunder(s.recordings, others, 0.4);
    }
    CHECK(rows_of(found_in(s)) == (recorded ? Rows{} : others));
  }
  // A blunder beside them stays one.
  blunder(s.recordings, {65}, 2);
  CHECK(rows_of(found_in(s)) == Rows{65});
}

TEST_CASE("too many are a group of their own") {
  Simulated s = simulated(arm(), 9);
  Rows third;
  for (std::size_t k = 0; k < s.recordings.rows(); k += 3) third.insert(k);
  blunder(s.recordings, third, 20);
  CHECK(rows_of(found_in(s)).empty());
}

TEST_CASE("the search depends on the seed alone, not on threads") {
  Simulated s = simulated(arm(), 10);
  blunder(s.recordings, {4, 9, 70}, 1);
  const Outliers one = found_in(s, {.threads = 1}), four = found_in(s, {.threads = 4});
  CHECK(one.x == four.x);
  CHECK(one.scale == four.scale);
  CHECK(rows_of(one) == rows_of(four));
}

TEST_CASE("a model without free parameters, and one without stated noise") {
  const Recordings published = read_recordings(shipped("isl-bonny-2013/recordings.csv"));
  Simulated s{program_of(shipped("isl-bonny-2013/published.xml")), published,
              random_split(published, 1)};
  CHECK(found_in(s).found.empty());
  Model model = model_of(shipped("arm-6r/model.xml"));
  set_calibrate(model, "weight", "1");
  s = simulated(arm(), 12);
  s.program = program_of(model);
  const Rows bad = blunder(s.recordings, {7, 8, 60, 133}, 2);
  CHECK(rows_of(found_in(s)) == bad);
}
