#include "framework/diagnosis/claims.h"

#include <doctest/doctest.h>

#include "framework/registry/registry.h"

using namespace talus;

namespace {

// Two effects of joint 2, with what chi-square loses without each of them.
Claims claims(double first, double second, double left = 1) {
  const Registry registry = Registry::built_in();
  Search search;
  for (const char* name : {"link_bending", "axis_tilt_wobble"}) {
    Accepted e;
    e.suspect.plugin = registry.find(name, Family::effect);
    REQUIRE(e.suspect.plugin);
    e.suspect.effect = name, e.suspect.joint = "joint2";
    e.suspect.location = e.suspect.at = "joint2";
    search.best.effects.push_back(e);
  }
  search.members = {{first, {}, {{search.best.effects[0], 0, 0, 1}}},
                    {second, {}, {{search.best.effects[1], 0, 0, 1}}}};
  search.null.cost2 = first + second + 400 * left;
  search.best.cost2 = 400 * left;
  search.left = left;
  return claims_of(search, 100, 600, UnitSystem{});
}

}  // namespace

TEST_CASE("what a formula right within a fifth would leave at its joint is not named") {
  const Claims small = claims(10000, 300), large = claims(10000, 500);
  REQUIRE(small.findings.size() == 1);
  CHECK(small.findings[0].effect == "link_bending");
  REQUIRE(small.hints.size() == 1);
  CHECK(small.hints[0].effect == "axis_tilt_wobble");
  CHECK(large.findings.size() == 2);
  CHECK(large.hints.empty());
}

TEST_CASE("beside what is not modelled a name is trusted as far as it outweighs that") {
  // 400 rows that leave 10 times the variance of the noise: 3,600 too much.
  const Claims far = claims(10800, 720, 10);
  REQUIRE(far.findings.size() == 1);
  CHECK(far.findings[0].probability == doctest::Approx(0.75));
  REQUIRE(far.hints.size() == 1);
  CHECK(far.hints[0].probability == doctest::Approx(720.0 / 4320));
  // A little more than the noise is a noise stated too small.
  const Claims near = claims(10800, 720, 2);
  CHECK(near.findings.size() == 2);
  CHECK(near.findings[0].probability == doctest::Approx(1));
  // The surest of all stays a finding.
  CHECK(claims(800, 700, 10).findings.size() == 1);
}
