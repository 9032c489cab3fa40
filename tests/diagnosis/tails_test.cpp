#include "framework/diagnosis/tails.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace talus;

// The numbers are those of mpmath at 60 digits.
TEST_CASE("tails of chi-square and F, near and far out") {
  const auto same = [](double value, double known) {
    CAPTURE(known);
    CHECK(std::abs(value - known) < 1e-10 * std::max(1.0, std::abs(known)));
  };
  same(log_chi2_tail(0.5, 1), -0.7350111298370844);
  same(log_chi2_tail(3.841458820694124, 1), -2.9957322735539898);
  same(log_chi2_tail(40, 2), -20);
  same(log_chi2_tail(1000, 1), -503.68066650438169);
  same(log_chi2_tail(1e5, 7), -49974.151477891071);
  same(log_chi2_tail(2.5, 6), -0.14102492429634372);
  same(log_chi2_tail(12300, 12000), -3.6074032084044819);
  same(log_chi2_tail(20000, 12000), -939.91012627399679);
  CHECK(log_chi2_tail(0, 3) == 0);

  same(log_f_tail(0.3, 2, 10), -0.29134454061987887);
  same(log_f_tail(4, 3, 40), -4.2716527028488637);
  same(log_f_tail(50, 1, 350), -25.502733367420209);
  same(log_f_tail(1000, 6, 360), -507.30885077541734);
  same(log_f_tail(2, 4, 12000), -2.3897624666269466);
  same(log_f_tail(1e6, 2, 30), -166.61213035124348);
}

TEST_CASE("noncentral tails, and the noncentrality that a threshold needs") {
  CHECK(noncentral_chi2_tail(13.8, 1, 21) == doctest::Approx(0.80723181477678).epsilon(1e-9));
  CHECK(noncentral_chi2_tail(17, 2, 22) == doctest::Approx(0.75236565210089).epsilon(1e-9));
  CHECK(noncentral_chi2_tail(30, 6, 100) == doctest::Approx(0.99999940377899).epsilon(1e-9));
  CHECK(log_chi2_tail(chi2_quantile(-12.5, 4), 4) == doctest::Approx(-12.5).epsilon(1e-9));
  const double lambda = needed_noncentrality(std::log(3e-4), 2, 0.8);
  CHECK(noncentral_chi2_tail(chi2_quantile(std::log(3e-4), 2), 2, lambda) ==
        doctest::Approx(0.8).epsilon(1e-9));
  CHECK(lambda > 20);
  CHECK(lambda < 24);
}
