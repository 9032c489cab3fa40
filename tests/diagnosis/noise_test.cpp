// Noise is told from what is no noise, and from noise that was not stated.
#include "framework/diagnosis/noise.h"

#include <doctest/doctest.h>

#include "tests/support/beds.h"

using namespace talus;
using namespace talus::testing;

namespace {

NoiseVerdict verdict(const Simulated& s) {
  const Fit fit = calibrate(s.program, s.recordings, s.split, {.restarts = 0});
  return judge_noise(s.program, s.recordings, s.split.fit, fit.x);
}

// The noise of every value replaced by a function of what it was: f(noise, row, column).
template <class F>
Simulated with_noise(const Bed& bed, std::uint64_t seed, F f) {
  Simulated s = simulated(bed, seed);
  const Recordings exact = record(bed, seed, nullptr, 0);
  for (std::size_t k = 0; k < exact.rows(); ++k)
    for (std::size_t c = 1; c < exact.columns.size(); ++c) {
      const double e = exact.columns[c].values[k];
      double& v = s.recordings.columns[c].values[k];
      v = e + f(v - e, k, c);
    }
  return s;
}

}  // namespace

// Measured on seeds that no threshold was chosen by: no fault in 400 runs, five of them not white.
TEST_CASE("noise as stated") {
  for (const Bed& bed : beds())
    for (std::uint64_t seed : {1, 2}) {
      CAPTURE(bed.file);
      const NoiseVerdict v = verdict(simulated(bed, seed));
      CHECK(v.statement == "What is left is noise, and as much as was stated.");
      CHECK(v.faults.empty());
      CHECK(v.scale == doctest::Approx(1).epsilon(0.15));
      CHECK(v.kurtosis == doctest::Approx(3).epsilon(0.25));
      CHECK(v.p > 1e-3);
    }
}

TEST_CASE("noise larger or smaller than stated, and nothing else") {
  for (const Bed& bed : beds()) {
    CAPTURE(bed.file);
    const NoiseVerdict larger = verdict(simulated(bed, 3, nullptr, 1.6));
    CHECK(larger.larger);
    CHECK_FALSE(larger.source);
    CHECK(larger.scale == doctest::Approx(1.6).epsilon(0.1));
    REQUIRE(larger.faults.size() == 1);
    CHECK(larger.faults[0].kind == "noise-larger-than-stated");
    const NoiseVerdict smaller = verdict(simulated(bed, 3, nullptr, 0.5));
    CHECK(smaller.smaller);
    REQUIRE(smaller.faults.size() == 1);
    CHECK(smaller.faults[0].kind == "noise-smaller-than-stated");
  }
}

TEST_CASE("one sensor noisier than stated") {
  const auto noisy = [](const char* sensor, const char* sigma) {
    return [=](Model& model) { set(model, std::string(sensor) + ".sigma", sigma); };
  };
  NoiseVerdict v = verdict(simulated(beds()[0], 4, noisy("encoder3", "0.04")));
  REQUIRE(v.source);
  CHECK(v.source->name == "encoder3");
  CHECK(v.source->ratio == doctest::Approx(4).epsilon(0.2));
  CHECK(v.source->rest == doctest::Approx(1).epsilon(0.1));
  REQUIRE(v.faults.size() == 1);
  CHECK(v.faults[0].where == "encoder3");
  v = verdict(simulated(beds()[1], 5, noisy("micrometer2", "0.0048")));
  REQUIRE(v.source);
  CHECK(v.source->name == "micrometer2");
}

TEST_CASE("one measured coordinate noisier than stated") {
  for (const Bed& bed : {arm(), beds()[4]}) {
    CAPTURE(bed.file);
    const std::string name = "E.y";
    Simulated s = simulated(bed, 6);
    const std::size_t y = &column(s.recordings, name) - s.recordings.columns.data();
    s = with_noise(bed, 6,
                   [=](double e, std::size_t, std::size_t c) { return c == y ? 4 * e : e; });
    const NoiseVerdict v = verdict(s);
    REQUIRE(v.source);
    CHECK(v.source->name == name);
    CHECK(v.source->ratio == doctest::Approx(4).epsilon(0.25));
  }
}

TEST_CASE("heavy tails, uneven noise, correlated noise") {
  const Bed& bed = beds()[0];
  Random random(8);
  std::vector<double> spread(bed.poses);  // Student's t with four degrees of freedom, pose by pose
  for (double& s : spread) {
    double chi2 = 0;
    for (int i = 0; i < 4; ++i) chi2 += std::pow(gauss(random), 2);
    s = std::sqrt(4 / chi2);
  }
  const NoiseVerdict heavy = verdict(
      with_noise(bed, 7, [&](double e, std::size_t k, std::size_t) { return e * spread[k]; }));
  CHECK(heavy.heavy);
  CHECK(heavy.student.value_or(0) > 3);
  CHECK(heavy.student.value_or(100) < 10);
  CHECK(heavy.faults.back().kind == "heavy-tails");

  const NoiseVerdict uneven = verdict(
      with_noise(bed, 7, [](double e, std::size_t k, std::size_t) { return k > 50 ? 3 * e : e; }));
  CHECK(uneven.uneven == "order");
  CHECK(uneven.faults.back().kind == "uneven-noise");

  std::vector<double> state(100, 0.0);
  const NoiseVerdict correlated =
      verdict(with_noise(beds()[4], 7, [&](double e, std::size_t, std::size_t c) {
        return state[c] = 0.7 * state[c] + std::sqrt(1 - 0.49) * e;
      }));
  CHECK(correlated.unwhite == "order");
  CHECK(correlated.correlation > 0.4);
  CHECK(correlated.faults.empty());
}

TEST_CASE("physics that was left out is not called noise") {
  const NoiseVerdict v =
      verdict(simulated(beds()[0], 9, disturbed(beds()[0], "{} + 2 deg*sin({})")));
  CHECK(v.unwhite == "theta3");
  CHECK(v.channel == "encoder3");
  CHECK_FALSE(v.larger);
  CHECK_FALSE(v.source);
  CHECK(v.faults.empty());
}
