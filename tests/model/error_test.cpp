#include "framework/model/error.h"

#include <doctest/doctest.h>

using namespace talus;

TEST_CASE("a complaint names the place, what was found and expected, and the nearest name") {
  const InputError error(Place{"models/arm.xml", 12, 18}, "<dh> has no attribute 'alhpa'",
                         "one of: name, theta, d, a, alpha", "alpha");
  CHECK(std::string(error.what()) ==
        "models/arm.xml:12:18: <dh> has no attribute 'alhpa'\n"
        "  expected one of: name, theta, d, a, alpha\n"
        "  did you mean 'alpha'?");
  CHECK(error.place().line == 12);
  CHECK(std::string(InputError("no model is given").what()) == "no model is given");
}

TEST_CASE("a place leaves out what is unknown") {
  CHECK(to_string(Place{"a.csv", 3, 7}) == "a.csv:3:7");
  CHECK(to_string(Place{"a.csv", 3}) == "a.csv:3");
  CHECK(to_string(Place{"a.csv"}) == "a.csv");
  CHECK(to_string(Place{"a.csv", 0, 7}) == "a.csv");
  CHECK(to_string(Place{"", 3, 7}) == "line 3:7");
  CHECK(to_string(Place{}) == "");
}

TEST_CASE("the nearest name") {
  const std::vector<std::string> names{"theta", "d", "a", "alpha", "theta10"};
  CHECK(nearest("alhpa", names) == "alpha");  // two neighbours swapped
  CHECK(nearest("thet", names) == "theta");
  CHECK(nearest("thetaa", names) == "theta");
  CHECK(nearest("zeta-function", names) == "");
  CHECK(nearest("alpha", names) == "alpha");
  CHECK(nearest("x", {}) == "");
}

TEST_CASE("a list of words") {
  CHECK(join({"a", "b", "c"}) == "a, b, c");
  CHECK(join({"a"}) == "a");
  CHECK(join({}) == "");
  CHECK(join({"N", "m"}, "*") == "N*m");
}
