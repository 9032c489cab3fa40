#include "framework/dsl/lua_effect.h"

#include <fmt/format.h>

#include <algorithm>

#include "framework/dsl/lua_plugin.h"
#include "framework/dsl/lua_sandbox.h"
#include "framework/dsl/lua_traced.h"

namespace talus::lua {
namespace {

using Words = std::vector<std::string>;

constexpr int kActs = 9, kCovariates = 10;

template <class E>
Words words_of(int count) {
  Words result;
  for (int i = 0; i < count; ++i) result.push_back(to_string(static_cast<E>(i)));
  return result;
}

bool at_joint(Acts acts) {
  return acts == Acts::coordinate || acts == Acts::axis || acts == Acts::about ||
         acts == Acts::link || acts == Acts::lengths;
}

// __index of `around`: what the effect did not ask for.
int missing_circumstance(lua_State* L) {
  const char* name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "?";
  guard(L, [&] {
    Words known;
    for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1))
      if (lua_type(L, -2) == LUA_TSTRING) known.push_back(lua_tostring(L, -2));
    std::sort(known.begin(), known.end());
    std::string need = name;
    if (need == "force" || need == "moment") need = "load";
    if (need == "tip_force" || need == "tip_moment" || need == "weight" || need == "span" ||
        need == "own_moment")
      need = "tip_load";
    const Words covariates = words_of<Covariate>(kCovariates);
    const bool covariate =
        std::find(covariates.begin(), covariates.end(), need) != covariates.end();
    throw InputError(LuaSandbox::of(L).place(L),
                     fmt::format("'{}' is not among the circumstances", name),
                     covariate ? fmt::format("needs = {{ \"{}\" }} in the definition", need)
                     : need == "driver" ? "driver = \"other\" (own, any) in the definition"
                     : known.empty()    ? "needs = { ... } in the definition"
                                        : "one of: " + join(known),
                     covariate ? "" : nearest(name, known));
  });
  return 0;
}

}  // namespace

const Words& LuaEffect::fields() {
  static const Words names{"acts",  "on",         "needs",    "driver",
                           "forms", "everywhere", "at_joint", "reference"};
  return names;
}

void LuaEffect::fail(const std::string& found, const std::string& expected,
                     const std::string& suggestion) const {
  throw InputError(place_, fmt::format("effect '{}': {}", d_.tag, found), expected, suggestion);
}

std::string LuaEffect::text(const std::string& name) const {
  if (lua_type(L_, -1) != LUA_TSTRING)
    fail(fmt::format("'{}' is a {}", name, luaL_typename(L_, -1)), "text");
  return lua_tostring(L_, -1);
}

bool LuaEffect::flag(const std::string& name) const {
  if (!lua_isboolean(L_, -1))
    fail(fmt::format("'{}' is a {}", name, luaL_typename(L_, -1)), "true or false");
  return lua_toboolean(L_, -1);
}

Words LuaEffect::words(const std::string& name) const {
  if (!lua_istable(L_, -1))
    fail(fmt::format("'{}' is a {}", name, luaL_typename(L_, -1)), "a list { ... }");
  Words result;
  const lua_Unsigned size = std::min<lua_Unsigned>(lua_rawlen(L_, -1), 1000);
  for (lua_Unsigned i = 1; i <= size; ++i) {
    lua_rawgeti(L_, -1, static_cast<lua_Integer>(i));
    result.push_back(text(name));
    lua_pop(L_, 1);
  }
  return result;
}

bool LuaEffect::field(const std::string& name) {
  auto one_of = [&](const std::string& word, const Words& known) {
    const auto it = std::find(known.begin(), known.end(), word);
    if (it == known.end())
      fail(fmt::format("'{}' in '{}'", word, name), "one of: " + join(known), nearest(word, known));
    return static_cast<int>(it - known.begin());
  };
  EffectTraits& effect = d_.effect;
  if (name == "acts") {
    effect.acts = static_cast<Acts>(one_of(text(name), words_of<Acts>(kActs)));
    has_acts_ = true;
  } else if (name == "on") {
    const Dimension* d = dimension_at(L_, -1);
    if (!d) fail(fmt::format("'on' is a {}", luaL_typename(L_, -1)), "on = angle, or on = length");
    effect.on = {*d};
  } else if (name == "needs") {
    for (const std::string& word : words(name))
      d_.needs(static_cast<Covariate>(one_of(word, words_of<Covariate>(kCovariates))));
  } else if (name == "driver") {
    const int which = one_of(text(name), {"other", "own", "any"});
    d_.driven_by(static_cast<Driven>(which + 1), "the joint or unknown whose coordinate drives it");
  } else if (name == "forms") {
    if (!lua_istable(L_, -1)) fail("'forms' is no list", "forms = { { \"a\", \"b\" }, { \"c\" } }");
    const lua_Unsigned size = std::min<lua_Unsigned>(lua_rawlen(L_, -1), 1000);
    for (lua_Unsigned i = 1; i <= size; ++i) {
      lua_rawgeti(L_, -1, static_cast<lua_Integer>(i));
      d_.form(words(name));
      lua_pop(L_, 1);
    }
  } else if (name == "everywhere") {
    effect.everywhere = flag(name);
  } else if (name == "at_joint") {
    effect.at_joint = flag(name);
  } else if (name == "reference") {
    effect.reference = text(name);
  } else {
    return false;
  }
  return true;
}

void LuaEffect::finish() {
  if (!has_acts_)
    fail("it does not say on what it acts",
         "acts = \"reading\", or one of: " + join(words_of<Acts>(kActs)));
  Words amounts;
  for (const Input& input : d_.inputs)
    if (input.role == Role::amount) amounts.push_back(input.name);
  if (amounts.empty())
    fail("it has no amount",
         "amount(angle, \"0.02 deg\", \"meaning\"), zero where nothing is wrong");
  for (const EffectForm& form : d_.effect.forms)
    for (const std::string& name : form.amounts)
      if (std::find(amounts.begin(), amounts.end(), name) == amounts.end())
        fail(fmt::format("'{}' in 'forms' is no amount", name), "one of: " + join(amounts),
             nearest(name, amounts));
}

void push_around(lua_State* L, const Around<Expr>& around, const EffectTraits& effect) {
  auto needs = [&](Covariate c) {
    return std::find(effect.needs.begin(), effect.needs.end(), c) != effect.needs.end();
  };
  auto add = [&](const char* name, const Expr& value, bool known) {
    if (!known) return;
    push_traced(L, value);
    lua_setfield(L, -2, name);
  };
  auto add3 = [&](const char* name, const Vector3<Expr>& value, bool known) {
    if (!known) return;
    lua_createtable(L, 3, 0);
    for (int i = 0; i < 3; ++i) {
      push_traced(L, value[i]);
      lua_rawseti(L, -2, i + 1);
    }
    lua_setfield(L, -2, name);
  };
  luaL_checkstack(L, 20, nullptr);
  lua_createtable(L, 0, 8);
  add("reading", around.reading, effect.acts == Acts::reading);
  add("coordinate", around.coordinate, at_joint(effect.acts));
  add("driver", around.driver, effect.driven != Driven::no);
  add("approach", around.approach, needs(Covariate::approach));
  add("time", around.time, needs(Covariate::time));
  add("session", around.session, needs(Covariate::session));
  add("pose", around.pose, needs(Covariate::pose));
  add("temperature", around.temperature, needs(Covariate::temperature));
  add("rate", around.rate, needs(Covariate::rate));
  add("travel", around.travel, needs(Covariate::travel));
  add("since", around.since, needs(Covariate::since));
  add3("force", around.force, needs(Covariate::load));
  add3("moment", around.moment, needs(Covariate::load));
  add3("tip_force", around.tip_force, needs(Covariate::tip_load));
  add3("tip_moment", around.tip_moment, needs(Covariate::tip_load));
  add3("weight", around.weight, needs(Covariate::tip_load));
  add3("span", around.span, needs(Covariate::tip_load));
  add3("own_moment", around.own_moment, needs(Covariate::tip_load));
  add3("position", around.position, effect.acts == Acts::measured);
  lua_createtable(L, 0, 1);
  lua_pushcfunction(L, missing_circumstance);
  lua_setfield(L, -2, "__index");
  lua_setmetatable(L, -2);
}

const char* read_act(lua_State* L, std::vector<Expr>& numbers) {
  static constexpr const char* parts[] = {"x", "y", "z", "rx", "ry", "rz"};
  if (numbers.size() == 1)
    return to_expr(L, -1, numbers[0]) ? nullptr
                                      : "a number such as p.height * sin(p.teeth * around.reading)";
  if (numbers.size() == 6) {
    const char* expected = "a table with some of x, y, z (mm), rx, ry, rz (rad)";
    if (!lua_istable(L, -1)) return expected;
    for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1)) {
      const auto* part = std::find_if(std::begin(parts), std::end(parts), [&](const char* name) {
        return lua_type(L, -2) == LUA_TSTRING && std::string_view(lua_tostring(L, -2)) == name;
      });
      if (part == std::end(parts)) {
        lua_pop(L, 2);
        return expected;
      }
      if (!to_expr(L, -1, numbers[part - std::begin(parts)])) return expected;
    }
    return nullptr;
  }
  const char* expected = "three rows of three numbers: { { xx, xy, xz }, { yx, ... }, ... }";
  if (!lua_istable(L, -1) || lua_rawlen(L, -1) != 3) return expected;
  for (int i = 0; i < 3; ++i) {
    lua_rawgeti(L, -1, i + 1);
    if (!lua_istable(L, -1) || lua_rawlen(L, -1) != 3) return expected;
    for (int j = 0; j < 3; ++j) {
      lua_rawgeti(L, -1, j + 1);
      if (!to_expr(L, -1, numbers[3 * i + j])) return expected;
      lua_pop(L, 1);
    }
    lua_pop(L, 1);
  }
  return nullptr;
}

}  // namespace talus::lua
