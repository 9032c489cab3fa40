// An effect written in Lua is the same as one written in C++, and what is wrong in one is said.
#include <doctest/doctest.h>

#include "framework/dsl/dsl.h"
#include "tests/support/plugin_check.h"

using namespace talus;
using namespace talus::testing;

namespace {

Registry with(const std::string& definitions) {
  Registry registry = Registry::built_in();
  read_lua(definitions + "\nreturn talus {}", "own.lua", registry);
  return registry;
}

std::string complaint(const std::string& definition) {
  try {
    const Registry registry = with("effect 'bad' {\n" + definition + " }");
    const Plugin& plugin = *registry.find("bad");
    Tape tape;
    std::vector<Expr> inputs;
    for (std::size_t i = 0; i < plugin.declaration.inputs.size(); ++i)
      inputs.push_back(Expr::leaf(tape, static_cast<int>(i)));
    plugin.act(Around<Expr>{.reading = inputs[0]}, inputs, {});
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing to complain about";
}

struct Twin {
  const char* tag;
  const char* lua;
};

// Each the twin of a built-in effect, with all its inputs in their order.
const Twin twins[] = {
    {"encoder_interpolation", R"(acts = "reading", on = angle,
  sine = amount(angle, "0.02 deg"), cosine = amount(angle, "0.02 deg"),
  order = setting(number, 8, { 6, 12 }),
  value = function(around, p)
    return p.sine * sin(p.order * around.reading) + p.cosine * cos(p.order * around.reading)
  end)"},
    {"hysteresis",
     R"(acts = "reading", on = angle, at_joint = true, needs = { "approach", "travel" },
  half_width = amount(angle, "0.03 deg"), reach = setting(angle, "5 deg", { "4 deg", 0.2 }),
  value = function(around, p)
    return p.half_width * around.approach * (1 - 2 * exp(-around.travel / p.reach))
  end)"},
    {"bearing_tilt_compliance", R"(acts = "axis", needs = { "load" },
  compliance = amount(unit('deg/(N*m)'), 0.001),
  value = function(around, p)
    return { rx = p.compliance * around.moment[1], ry = p.compliance * around.moment[2] }
  end)"},
    {"coupled_motion", R"(acts = "axis", driver = "any", forms = { { "ratio" }, { "lead" } },
  ratio = amount(number, 0.001), lead = amount(unit("mm/deg"), 0.1),
  value = function(around, p)
    return { z = p.lead * around.driver, rz = p.ratio * around.driver }
  end)"},
    {"measurement_squareness", R"(acts = "measured",
  xy = amount(angle, "0.01 deg"), xz = amount(angle, "0.01 deg"), yz = amount(angle, "0.01 deg"),
  value = function(around, p)
    return { { 0, sin(p.xy), sin(p.xz) }, { 0, 0, sin(p.yz) }, { 0, 0, 0 } }
  end)"},
    {"thermal_expansion", R"(acts = "lengths", everywhere = true, needs = { "temperature" },
  coefficient = amount(unit("1/K"), 2e-5), reference = setting(temperature, 20),
  value = function(around, p) return p.coefficient * (around.temperature - p.reference) end)"},
};

}  // namespace

TEST_CASE("a Lua effect equals its C++ twin and passes the test of every plugin") {
  for (const auto& [tag, lua] : twins) {
    CAPTURE(tag);
    const Registry registry = with(std::string("effect 'twin' {\n") + lua + " }");
    const Plugin &twin = *registry.find("twin"), &own = *registry.find(tag);
    const Declaration &d = twin.declaration, &like = own.declaration;
    check_plugin(twin);
    CHECK(d.effect.acts == like.effect.acts);
    CHECK(d.effect.needs == like.effect.needs);
    CHECK(d.effect.everywhere == like.effect.everywhere);
    CHECK(d.effect.at_joint == like.effect.at_joint);
    REQUIRE(d.inputs.size() == like.inputs.size());
    for (std::size_t i = 0; i < d.inputs.size(); ++i) {
      CHECK(d.inputs[i].name == like.inputs[i].name);
      CHECK(d.inputs[i].role == like.inputs[i].role);
      CHECK(d.inputs[i].dimension == like.inputs[i].dimension);
      CHECK(d.inputs[i].otherwise == doctest::Approx(like.inputs[i].otherwise));
    }
    Random random(2);
    Leaves leaves;
    const Circumstances circumstances(leaves, like, corrected_by(like)[0]);
    const auto inputs = leaves.add(like.inputs);
    const auto a = twin.act(circumstances.around, inputs, {}),
               b = own.act(circumstances.around, inputs, {});
    REQUIRE(a.size() == b.size());
    std::vector<double> slots;
    for (const Input& input : leaves.drawn) slots.push_back(sensible(random, input));
    for (std::size_t i = 0; i < a.size(); ++i)
      CHECK(value_of(a[i], slots) == doctest::Approx(value_of(b[i], slots)).epsilon(1e-14));
  }
}

TEST_CASE("usual sizes and values to try are taken with their units") {
  const Registry registry = with(std::string("effect 'twin' {\n") + twins[1].lua + " }");
  const Declaration& d = registry.find("twin")->declaration;
  CHECK(d.inputs[0].typical == doctest::Approx(0.03 * deg));
  CHECK(d.inputs[1].tries == std::vector<double>{4 * deg, 0.2});
  const Registry coupled = with(std::string("effect 'twin' {\n") + twins[3].lua + " }");
  const EffectTraits& effect = coupled.find("twin")->declaration.effect;
  CHECK(effect.driven == Driven::by_any);
  REQUIRE(effect.forms.size() == 2);
  CHECK(effect.forms[1].amounts == std::vector<std::string>{"lead"});
}

TEST_CASE("what is wrong in a Lua effect is said with its line") {
  struct Case {
    const char *lua, *words;
  };
  const Case cases[] = {
      {"value = function(around, p) return 0 end",
       R"(own.lua:1: effect 'bad': it does not say on what it acts
  expected acts = "reading", or one of: reading, coordinate, axis, about, link, lengths, fixture, tip, measured)"},
      {"acts = 'redaing', value = function(around, p) return 0 end",
       R"(own.lua:1: effect 'bad': 'redaing' in 'acts'
  expected one of: reading, coordinate, axis, about, link, lengths, fixture, tip, measured
  did you mean 'reading'?)"},
      {"acts = 'reading', height = amount(angle, '1 deg')",
       R"(own.lua:1: effect 'bad': there is no value
  expected value = function(...) ... end)"},
      {"acts = 'reading', value = function(around, p) return 0 end",
       R"(own.lua:1: effect 'bad': it has no amount
  expected amount(angle, "0.02 deg", "meaning"), zero where nothing is wrong)"},
      {"acts = 'reading', height = angle(0), value = function(around, p) return 0 end",
       R"(own.lua:1: effect 'bad': 'height' is neither an amount nor a setting
  expected amount(angle, "0.02 deg"), zero where nothing is wrong, or setting(number, 8))"},
      {"acts = 'reading',\n  height = amount(angle), value = function(around, p) return 0 end",
       R"(own.lua:3: an amount needs its usual size, above zero
  expected amount(angle, "0.02 deg", "meaning"))"},
      {"acts = 'reading', height = amount(angle, 1), needs = { 'lod' },\n"
       "  value = function(around, p) return 0 end",
       R"(own.lua:1: effect 'bad': 'lod' in 'needs'
  expected one of: approach, time, session, pose, temperature, rate, travel, since, load, tip_load
  did you mean 'load'?)"},
      {"acts = 'reading', height = amount(angle, 1),\n"
       "  value = function(around, p) return p.height * around.force[1] end",
       R"(own.lua:3: 'force' is not among the circumstances
  expected needs = { "load" } in the definition)"},
      {"acts = 'reading', height = amount(angle, 1), needs = { 'time' },\n"
       "  value = function(around, p) return p.height * around.raeding end",
       R"(own.lua:3: 'raeding' is not among the circumstances
  expected one of: reading, time
  did you mean 'reading'?)"},
      {"acts = 'reading', height = amount(angle, 1),\n"
       "  value = function(around, p) return { p.height } end",
       R"(own.lua:3: effect 'bad': its function returns a table of 1
  expected a number such as p.height * sin(p.teeth * around.reading))"},
      {"acts = 'tip', height = amount(length, 1),\n"
       "  value = function(around, p) return { xy = p.height } end",
       R"(own.lua:3: effect 'bad': its function returns a table of 0
  expected a table with some of x, y, z (mm), rx, ry, rz (rad))"},
      {"acts = 'measured', height = amount(number, 1),\n"
       "  value = function(around, p) return { { p.height, 0, 0 }, { 0, 0, 0 } } end",
       R"(own.lua:3: effect 'bad': its function returns a table of 2
  expected three rows of three numbers: { { xx, xy, xz }, { yx, ... }, ... })"},
      {"acts = 'reading', height = amount(angle, 1), forms = { { 'heigth' } },\n"
       "  value = function(around, p) return 0 end",
       R"(own.lua:1: effect 'bad': 'heigth' in 'forms' is no amount
  expected one of: height
  did you mean 'height'?)"},
      {"acts = 'reading', hight = 3, value = function(around, p) return 0 end",
       R"(own.lua:1: effect 'bad': 'hight' is a number
  expected an input such as amount(angle, "0.02 deg"), or one of: summary, value, acts, on, needs, driver, forms, everywhere, at_joint, reference)"},
  };
  for (const auto& [lua, words] : cases) {
    CAPTURE(lua);
    CHECK(complaint(lua) == words);
  }
  CHECK_THROWS_WITH_AS(
      with("joint 'bad' { q = amount(angle, 1), transform = function(p) return p end }"),
      doctest::Contains("'q' is an amount or a setting"), InputError);
}
