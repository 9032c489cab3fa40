// One test for every plugin there is: a new one falls under it by being registered.
#include <doctest/doctest.h>

#include "tests/support/plugin_check.h"

namespace talus {

TEST_CASE("every registered plugin: declaration, derivatives, both syntaxes") {
  const auto plugins = Registry::built_in().all();
  CHECK(plugins.size() >= 30);
  for (const Plugin* plugin : plugins) {
    CHECK(plugin->origin == "built in");
    testing::check_plugin(*plugin);
  }
}

TEST_CASE("the reference of the generic test gives known derivatives") {
  Tape tape;
  const Expr x = Expr::leaf(tape, 0);
  const auto d = reference::sure_difference({sin(x) * x}, {0.7L}, 0, 1e-3L, 1e-11L);
  REQUIRE(d);
  CHECK(double((*d)[0]) == doctest::Approx(std::sin(0.7) + 0.7 * std::cos(0.7)).epsilon(1e-14));
}

TEST_CASE("the reference refuses corners") {
  Tape tape;
  const Expr x = Expr::leaf(tape, 0);
  CHECK(!reference::sure_difference({abs(x)}, {1e-3L}, 0, 1e-3L, 1e-11L));
  CHECK(!reference::sure_difference({acos(x)}, {1.0L}, 0, 1e-3L, 1e-11L));
}

TEST_CASE("a residual may bear the name of an element, no other name is taken twice") {
  Registry registry = Registry::built_in();
  CHECK(registry.find("direction", Family::feature));
  CHECK(registry.find("direction", Family::residual));
  CHECK(registry.find("direction")->declaration.family == Family::feature);
  CHECK_THROWS_AS(registry.add(*registry.find("direction", Family::residual)), InputError);
  CHECK_THROWS_AS(registry.add(*registry.find("dh")), InputError);
}

}  // namespace talus
