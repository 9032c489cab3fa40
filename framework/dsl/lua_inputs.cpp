#include <fmt/format.h>

#include <new>

#include "framework/dsl/grammar.h"
#include "framework/dsl/lua_elements.h"
#include "framework/dsl/lua_plugin.h"
#include "framework/dsl/lua_sandbox.h"
#include "framework/model/quantity.h"

namespace talus::lua {
namespace {

constexpr lua_Unsigned longest_text = 100, most_tries = 1000;

// A dimension in Lua: user data that can be called.
struct DimensionSpec {
  const char* name = "";  // of the global; "" for unit(...)
  Dimension dimension;
  double factor = 1, offset = 0;  // of plain numbers
};

constexpr DimensionSpec named[] = {
    {"number", number},     {"length", length}, {"angle", angle},
    {"duration", duration}, {"mass", mass},     {"temperature", temperature},
    {"count", count},       {"force", force},   {"torque", torque}};

const char input_key = 0, dimension_key = 0,
           order_key = 0;  // their addresses are keys of Lua's registry

// Is the value at `index` user data with the metatable kept under `key`? Does not raise.
bool is_kind(lua_State* L, int index, const char* key) {
  if (lua_type(L, index) != LUA_TUSERDATA || !lua_getmetatable(L, index)) return false;
  lua_rawgetp(L, LUA_REGISTRYINDEX, key);
  const bool same = lua_rawequal(L, -1, -2);
  lua_pop(L, 2);
  return same;
}

// Makes the user data on top of the stack one of `key`'s kind.
void set_kind(lua_State* L, const char* key) {
  lua_rawgetp(L, LUA_REGISTRYINDEX, key);
  lua_setmetatable(L, -2);
}

void push_dimension(lua_State* L, const DimensionSpec& d) {
  new (lua_newuserdatauv(L, sizeof(DimensionSpec), 0)) DimensionSpec(d);
  set_kind(L, &dimension_key);
}

const DimensionSpec& dimension_argument(lua_State* L) {
  if (!is_kind(L, 1, &dimension_key))
    refuse(L, "the first argument is no dimension",
           "length, angle, number, unit(\"N*m\") or the like");
  return *static_cast<const DimensionSpec*>(lua_touserdata(L, 1));
}

// Pushes an input whose meaning is the argument at `meaning`.
InputSpec* push_input(lua_State* L, int meaning) {
  if (!lua_isnoneornil(L, meaning)) luaL_checktype(L, meaning, LUA_TSTRING);
  lua_rawgetp(L, LUA_REGISTRYINDEX, &order_key);
  const lua_Integer order = lua_tointeger(L, -1) + 1;
  lua_pushinteger(L, order);
  lua_rawsetp(L, LUA_REGISTRYINDEX, &order_key);
  auto* input = new (lua_newuserdatauv(L, sizeof(InputSpec), 2)) InputSpec;
  input->order = order;
  if (!lua_isnoneornil(L, meaning)) {
    lua_pushvalue(L, meaning);
    lua_setiuservalue(L, -2, 1);
  }
  set_kind(L, &input_key);
  return input;
}

// The number at `index`: in the dimension's own unit, or text with a unit.
double number_argument(lua_State* L, const DimensionSpec& d, int index) {
  if (lua_type(L, index) != LUA_TSTRING) return d.factor * luaL_checknumber(L, index) + d.offset;
  const char* text = lua_tostring(L, index);
  if (lua_rawlen(L, index) > longest_text) refuse(L, "the default is too long");
  double value = 0;
  guard(L, [&] {
    UnitSystem internal;
    internal.angle = {"rad", angle, 1, 0};
    const Place place = LuaSandbox::of(L).place(L);
    const Quantity q = parse_quantity(text, d.dimension, internal, place);
    if (q.free || q.bounds)
      throw InputError(place, fmt::format("the default '{}' has a tolerance or bounds", text),
                       "a fixed number; tolerances are given by models");
    value = q.value;
  });
  return value;
}

// length(0, "meaning"), length("3 mm"), length() -- or the element length { ... }.
int call_dimension(lua_State* L) {
  const DimensionSpec d = dimension_argument(L);
  if (lua_istable(L, 2)) {
    bool element = false;
    guard(L, [&] {
      const auto* reading = LuaSandbox::of(L).reading;
      element = d.name[0] && reading && rule_of(d.name, *reading->registry);
    });
    if (!element)
      refuse(L, "a dimension is called with a table", "a default: length(0, \"meaning\")");
    lua_remove(L, 1);
    return construct(L, d.name);
  }
  const bool required = lua_isnoneornil(L, 2);
  const double otherwise = required ? 0 : number_argument(L, d, 2);
  InputSpec* input = push_input(L, 3);
  input->dimension = d.dimension;
  input->required = required;
  input->otherwise = otherwise;
  return 1;
}

int coordinate(lua_State* L) {
  const DimensionSpec& d = dimension_argument(L);
  InputSpec* input = push_input(L, 2);
  input->dimension = d.dimension;
  input->coordinate = input->required = true;
  return 1;
}

int choice(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  InputSpec* input = push_input(L, 2);
  input->choice = true;
  lua_pushvalue(L, 1);
  lua_setiuservalue(L, -2, 2);
  return 1;
}

// amount(angle, "0.02 deg", "meaning"): of effects, with its usual size.
int amount(lua_State* L) {
  const DimensionSpec d = dimension_argument(L);
  const double typical = lua_isnoneornil(L, 2) ? 0 : number_argument(L, d, 2);
  if (!(typical > 0))
    refuse(L, "an amount needs its usual size, above zero",
           "amount(angle, \"0.02 deg\", \"meaning\")");
  InputSpec* input = push_input(L, 3);
  input->dimension = d.dimension;
  input->role = Role::amount;
  input->typical = typical;
  return 1;
}

// setting(number, 8, { 6, 12 }, "meaning"), setting(number, 8, "meaning")
int setting(lua_State* L) {
  const DimensionSpec d = dimension_argument(L);
  const double otherwise = number_argument(L, d, 2);
  const bool tries = lua_istable(L, 3);
  if (tries) {
    const lua_Unsigned size = lua_rawlen(L, 3);
    if (size > most_tries) refuse(L, "a setting has too many values to try", "at most 1000");
    lua_createtable(L, static_cast<int>(size), 0);
    for (lua_Unsigned i = 1; i <= size; ++i) {
      lua_rawgeti(L, 3, static_cast<lua_Integer>(i));
      const double value = number_argument(L, d, lua_gettop(L));
      lua_pop(L, 1);
      lua_pushnumber(L, value);
      lua_rawseti(L, -2, static_cast<lua_Integer>(i));
    }
    lua_replace(L, 3);
  }
  InputSpec* input = push_input(L, tries ? 4 : 3);
  input->dimension = d.dimension;
  input->otherwise = otherwise;
  input->role = Role::setting;
  if (tries) {
    lua_pushvalue(L, 3);
    lua_setiuservalue(L, -2, 2);
  }
  return 1;
}

int unit(lua_State* L) {
  const char* text = luaL_checkstring(L, 1);
  if (lua_rawlen(L, 1) > longest_text) refuse(L, "the unit is too long");
  DimensionSpec d;
  guard(L, [&] {
    const auto unit = parse_unit(text);
    if (!unit)
      throw InputError(LuaSandbox::of(L).place(L), fmt::format("'{}' is no unit", text),
                       "a unit such as mm, deg/(N*m) or 1/K");
    d = {"", unit->dimension, unit->factor, unit->offset};
  });
  push_dimension(L, d);
  return 1;
}

void make_kind(lua_State* L, const char* key, const char* name, lua_CFunction call) {
  lua_createtable(L, 0, 2);
  lua_pushstring(L, name);
  lua_setfield(L, -2, "__name");
  if (call) {
    lua_pushcfunction(L, call);
    lua_setfield(L, -2, "__call");
  }
  lua_rawsetp(L, LUA_REGISTRYINDEX, key);
}

}  // namespace

const Dimension* dimension_at(lua_State* L, int index) {
  if (!is_kind(L, index, &dimension_key)) return nullptr;
  return &static_cast<const DimensionSpec*>(lua_touserdata(L, index))->dimension;
}

const InputSpec* input_at(lua_State* L, int index) {
  if (!is_kind(L, index, &input_key)) return nullptr;
  return static_cast<const InputSpec*>(lua_touserdata(L, index));
}

void install_inputs(lua_State* L) {
  make_kind(L, &input_key, "input", nullptr);
  make_kind(L, &dimension_key, "dimension", call_dimension);
  for (const DimensionSpec& d : named) {
    push_dimension(L, d);
    lua_setglobal(L, d.name);
  }
  lua_register(L, "coordinate", coordinate);
  lua_register(L, "choice", choice);
  lua_register(L, "amount", amount);
  lua_register(L, "setting", setting);
  lua_register(L, "unit", unit);
}

}  // namespace talus::lua
