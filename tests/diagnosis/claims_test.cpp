#include "framework/diagnosis/claims.h"

#include <doctest/doctest.h>

#include "framework/registry/registry.h"

using namespace talus;

namespace {

// Two effects of joint 2, with what chi-square loses without each of them.
Claims claims(double first, double second) {
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
  search.members = {{first, {}, {}}, {second, {}, {}}};
  search.null.cost2 = first + second + 400;
  search.best.cost2 = 400;
  search.left = 1;
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
