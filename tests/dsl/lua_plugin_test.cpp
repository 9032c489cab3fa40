// A joint, sensor or residual written in Lua is the same as one written in C++.
#include <doctest/doctest.h>

#include <array>

#include "framework/dsl/dsl.h"

using namespace talus;

namespace {

Registry with(const std::string& definitions) {
  Registry registry = Registry::built_in();
  read_lua(definitions + "\nreturn talus {}", "own.lua", registry);
  return registry;
}

std::string complaint(const std::string& definitions) {
  try {
    with(definitions);
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing to complain about";
}

// A plugin's inputs as leaves of a tape, and numbers for them.
struct Leaves {
  Tape tape;
  std::vector<Expr> inputs;
  std::vector<double> values;

  explicit Leaves(std::vector<double> numbers) : values(std::move(numbers)) {
    for (int i = 0; i < int(values.size()); ++i) inputs.push_back(Expr::leaf(tape, i));
  }
  double operator()(const Expr& e) {
    return e.is_constant() ? e.constant() : tape.evaluate(e.node(), values);
  }
};

double largest_difference(Leaves& leaves, const Rigid<Expr>& a, const Rigid<Expr>& b) {
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    largest = std::max(largest, std::abs(leaves(a.translation(i)) - leaves(b.translation(i))));
    for (int j = 0; j < 3; ++j)
      largest = std::max(largest, std::abs(leaves(a.rotation(i, j)) - leaves(b.rotation(i, j))));
  }
  return largest;
}

// What is heard when the function of `joint "bad"` with one input p.q is called.
std::string heard_when_called(const std::string& body) {
  const Registry registry = with(
      "local kept\njoint \"bad\" { q = coordinate(angle), d = length(0),\n  transform = "
      "function(p)\n    " +
      body + "\n  end }");
  try {
    for (int i = 0; i < 2; ++i) {
      Leaves leaves({0.5, 2});
      registry.find("bad")->transform(leaves.inputs, {});
    }
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing to complain about";
}

}  // namespace

TEST_CASE("a Lua joint equals its C++ twin") {
  const Registry registry = with(R"(
    joint "dh2" {
      summary = "Denavit-Hartenberg joint, distal form",
      theta = coordinate(angle, "rotation about z of A"),
      d = length(0, "offset along z of A"), a = length("1 cm"), alpha = angle("90 deg", "twist about x of B"),
      transform = function(p)
        return rotate_z(p.theta) * translate_z(p.d) * translate_x(p.a) * rotate_x(p.alpha)
      end })");
  const Plugin &lua = *registry.find("dh2", Family::joint),
               &cpp = *registry.find("dh", Family::joint);
  CHECK(lua.origin == "own.lua");
  CHECK(lua.declaration.lua);
  REQUIRE(lua.declaration.inputs.size() == 4);
  for (int i = 0; i < 4; ++i) {
    CHECK(lua.declaration.inputs[i].name == cpp.declaration.inputs[i].name);
    CHECK(lua.declaration.inputs[i].dimension == cpp.declaration.inputs[i].dimension);
    CHECK(lua.declaration.inputs[i].coordinate == cpp.declaration.inputs[i].coordinate);
  }
  CHECK(lua.declaration.inputs[2].otherwise == 10);
  CHECK(lua.declaration.inputs[2].meaning == "defined in own.lua");
  CHECK(lua.declaration.inputs[3].otherwise == doctest::Approx(1.5707963267948966));
  Leaves leaves({0.7, 12, -30, 1.1});
  const auto a = lua.transform(leaves.inputs, {});
  CHECK(largest_difference(leaves, a, cpp.transform(leaves.inputs, {})) == 0);
  CHECK(a.motions().size() == 4);  // the product is kept as one, as in C++
}

TEST_CASE("the transforms of Lua") {
  const Registry registry = with(R"(
    joint "all" { q = coordinate(angle), x = length(0), order = choice({ "one", "two" }, "which"),
      transform = function(p)
        local T = rotate_x(0.1) * rotate_y(p.q) * translate(p.x, 2, 3) * rotate_about(1, 2, 3, p.q)
        local x, y, z = T:point(1, p.x, 0)
        local U = translate(x - T:rotation(1, 2) - T:translation(1), y - T:rotation(2, 2) * p.x, z)
        local rx, ry, rz = rotation_vector(rotate_by_vector(p.q, 0.2, -0.1))
        if p.order == "two" then return inverse(T) * T end
        return T * U * rotate_by_vector(rx, ry, rz) * translate_x(p.x % 5 + p.x // 5 * 5)
      end })");
  const Plugin& lua = *registry.find("all", Family::joint);
  Leaves leaves({0.6, 13});
  const Expr &q = leaves.inputs[0], &x = leaves.inputs[1];
  const Rigid<Expr> T = rotate_x(Expr(0.1)) * rotate_y(q) * translate(x, Expr(2), Expr(3)) *
                        rotate_about(Expr(1), Expr(2), Expr(3), q);
  const Vector3<Expr> p = T * Vector3<Expr>{1, x, 0};
  const Rigid<Expr> U =
      translate(p[0] - T.rotation(0, 1) - T.translation(0), p[1] - T.rotation(1, 1) * x, p[2]);
  const int one[] = {0}, two[] = {1};
  CHECK(largest_difference(leaves, lua.transform(leaves.inputs, one),
                           T * U * rotate_by_vector(q, Expr(0.2), Expr(-0.1)) * translate_x(x)) <
        1e-12);
  CHECK(largest_difference(leaves, lua.transform(leaves.inputs, two), Rigid<Expr>()) < 1e-12);
}

TEST_CASE("the functions of Lua") {
  const auto value = [](const std::string& expression, double reading, double slope) {
    const Registry registry = with(
        "sensor \"s\" { reading = angle, gives = angle, slope = number(1), "
        "value = function(r, p) local k = p.slope; return " +
        expression + " end }");
    Leaves leaves({reading, slope});
    return leaves(
        registry.find("s")->value(leaves.inputs[0], std::span(leaves.inputs).subspan(1), {}));
  };
  CHECK(value("k * r + 1", 2, 3) == 7);
  CHECK(value("-r / k - r ^ 2 + r ^ -1", 2, 4) == doctest::Approx(-4));
  CHECK(value("r ^ 0.5 + r ^ 1.5", 4, 0) == doctest::Approx(10));
  CHECK(value("sin(r) + math.sin(r)", 0.3, 0) == 2 * std::sin(0.3));
  CHECK(value("math.atan(r, k) + atan2(r, k) + math.atan(r)", 0.3, 2) ==
        doctest::Approx(2 * std::atan2(0.3, 2) + std::atan(0.3)));
  CHECK(value("select(less(r, k), 10, 20) + select(less(k, r), 1, 2)", 1, 2) == 12);
  CHECK(value("abs(r) + sign(r) + floor(r) + sqrt(k) + log(exp(k)) + math.log(k, 2)", -1.5, 4) ==
        doctest::Approx(1.5 - 1 - 2 + 2 + 4 + 2));
  CHECK(value("90 * deg + pi", 0, 0) == doctest::Approx(4.71238898038469));
  CHECK(value("select(2, 'a', k) + select('#', r, k)", 0, 5) == 7);
}

TEST_CASE("a Lua residual") {
  const Registry registry = with(R"(
    residual "offset" { of = { "frame", "point" }, rows = { "ox", length, "turn", angle }, arm = length(100, "lever"),
      value = function(model, measured, p)
        return { measured.frame:translation(1) - model:translation(1), p.arm * measured.frame:rotation(2, 1) }
      end })");
  const Plugin& lua = *registry.find("offset", Family::residual);
  REQUIRE(lua.declaration.columns.size() == 2);
  CHECK(lua.declaration.columns[1].suffix == "turn");
  CHECK(lua.declaration.columns[1].dimension == angle);
  CHECK(lua.declaration.kinds == std::vector{Kind::frame, Kind::point});
  Leaves leaves({50, 3, 0.1});
  Observed<Expr> measured{Kind::frame};
  measured.frame = translate_x(leaves.inputs[1]) * rotate_z(leaves.inputs[2]);
  const auto rows = lua.rows(translate_x(Expr(1)), measured, std::span(leaves.inputs).first(1), {});
  CHECK(leaves(rows[0]) == 2);
  CHECK(leaves(rows[1]) == doctest::Approx(50 * std::sin(0.1)));
}

TEST_CASE("complaints when a Lua plugin is defined") {
  CHECK(complaint("joint \"dh\" { q = coordinate(angle), transform = function(p) return "
                  "rotate_z(p.q) end }") ==
        "own.lua:1: plugin 'dh': its tag is taken by a joint (built in)");
  CHECK(
      complaint("joint \"chain\" { transform = function(p) return rotate_z(0) end }") ==
      "own.lua:1: joint 'chain': its tag is that of a part of every model\n  expected another tag");
  CHECK(complaint("\njoint \"a\" { q = coordinate(angle), transfrom = function(p) end }") ==
        "own.lua:2: joint 'a': 'transfrom' is a function\n"
        "  expected an input such as length(0), or one of: summary, transform\n  did you mean "
        "'transform'?");
  CHECK(
      complaint("joint \"a\" { q = coordinate(angle) }") ==
      "own.lua:1: joint 'a': there is no transform\n  expected transform = function(...) ... end");
  CHECK(complaint("joint \"a\" { d = length, transform = function(p) end }") ==
        "own.lua:1: joint 'a': 'd' is a dimension without a default\n"
        "  expected d = length(0), d = length() where it must be given, or the like");
  CHECK(complaint("joint \"a\" { mass = mass(1), transform = function(p) end }") ==
        "own.lua:1: joint 'a': 'mass' is an attribute of every joint\n  expected another name for "
        "this input");
  CHECK(complaint("joint \"a\" { d = length(\"3 deg\"), transform = function(p) end }")
            .substr(0, 11) == "own.lua:1: ");
  CHECK(complaint("residual \"a\" { value = function() end }") ==
        "own.lua:1: residual 'a': no rows are declared\n  expected rows = { \"x\", length, \"y\", "
        "length }");
}

TEST_CASE("complaints when a Lua plugin is called") {
  CHECK(heard_when_called("return rotate_z(p.q)") == "nothing to complain about");
  CHECK(heard_when_called("return p.q") ==
        "own.lua:3: joint 'bad': its function returns a traced number\n"
        "  expected a transform such as rotate_z(p.theta) * translate_x(p.a)");
  CHECK(heard_when_called("return") ==
        "own.lua:3: joint 'bad': its function returns a nil\n"
        "  expected a transform such as rotate_z(p.theta) * translate_x(p.a)");
  CHECK(heard_when_called("if p.q < 0 then return rotate_x(0) end") ==
        "own.lua:4: traced numbers cannot be compared: their values are not known yet\n"
        "  expected select(less(a, b), x, y), which is x where a < b and y elsewhere");
  CHECK(heard_when_called("return rotate_z(math.max(p.q, p.d))") ==
        "own.lua:4: traced numbers cannot be compared: their values are not known yet\n"
        "  expected select(less(a, b), x, y), which is x where a < b and y elsewhere");
  CHECK(heard_when_called("return rotate_z(2 ^ p.q)") ==
        "own.lua:4: the exponent of '^' is a traced number\n"
        "  expected a constant exponent, or exp(x * log(a)) for a^x");
  CHECK(heard_when_called("return rotate_z(p.qq)") ==
        "own.lua:4: 'qq' is not among the inputs\n  expected one of: d, q\n  did you mean 'q'?");
  CHECK(heard_when_called("return rotate_z(p.q) * p.d") ==
        "own.lua:4: bad argument #2 to 'mul' (transform expected, got traced number)");
  CHECK(heard_when_called("return rotat_z(p.q)") ==
        "own.lua:4: nothing is called 'rotat_z' here\n"
        "  expected a variable set before, or the tag of a registered plugin\n  did you mean "
        "'rotate_z'?");
  CHECK(heard_when_called("while true do end") ==
        "own.lua:4: stopped after 50 million steps\n"
        "  expected a model file that is read in a moment; is there a loop without an end?");
  CHECK(heard_when_called("kept = kept or p.q; return rotate_z(kept)") ==
        "own.lua:4: a traced number is used after the call that made it\n"
        "  expected no numbers kept between calls");
  CHECK(heard_when_called("kept = kept or rotate_z(p.q); return kept") ==
        "own.lua:3: a transform is used after the call that made it\n"
        "  expected no transforms kept between calls");
  CHECK(heard_when_called("local T = rotate_z(p.q); while true do T = T * T end") ==
        "own.lua:4: a product of more than 1000 motions");
  CHECK(heard_when_called("local x = p.q; while true do x = x * x + p.d end") ==
        "own.lua:4: more than a million operations are recorded");
  CHECK(heard_when_called("dh { name = 'j', theta = 'q' }") ==
        "own.lua:4: nothing is called 'dh' here\n"
        "  expected a variable set before, or the tag of a registered plugin");
}
