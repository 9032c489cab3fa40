#include "framework/dsl/lua_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "framework/dsl/grammar.h"
#include "framework/dsl/lua_sandbox.h"
#include "framework/dsl/read.h"
#include "framework/dsl/text.h"

namespace talus::lua {
namespace {

const char tags_key = 0, lines_key = 0;  // their addresses are keys of Lua's registry

int construct_tag(lua_State* L) { return construct(L, lua_tostring(L, lua_upvalueindex(1))); }

// Throws what is wrong with a global that does not exist.
[[noreturn]] void undefined(lua_State* L, std::string_view name) {
  const Place place = LuaSandbox::of(L).place(L);
  if (is_forbidden_in_lua(name))
    throw InputError(place, fmt::format("'{}' is not available in a model file", name),
                     name == "next" || name == "print" ? "" : "only what describes a model");
  std::vector<std::string> known;
  if (const auto* reading = LuaSandbox::of(L).reading)
    for (const ElementRule& rule : all_rules(*reading->registry)) known.push_back(rule.tag);
  int count = 0;
  lua_rawgeti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
  for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1), ++count)
    if (lua_type(L, -2) == LUA_TSTRING) known.push_back(lua_tostring(L, -2));
  lua_pop(L, 1);
  std::sort(known.begin(), known.end());
  throw InputError(place, fmt::format("nothing is called '{}' here", name),
                   "a variable set before, or the tag of a registered plugin",
                   nearest(name, known));
}

// __index of the globals.
int missing_global(lua_State* L) {
  if (lua_type(L, 2) != LUA_TSTRING) return 0;
  const char* name = lua_tostring(L, 2);
  guard(L, [&] {
    const auto* reading = LuaSandbox::of(L).reading;
    if (!reading || !(rule_of(name, *reading->registry) || reading->registry->find(name)))
      undefined(L, name);
  });
  lua_pushvalue(L, 2);
  lua_pushcclosure(L, &construct_tag, 1);
  lua_pushvalue(L, 2);
  lua_pushvalue(L, -2);
  lua_rawset(L, 1);
  return 1;
}

void load_plugin_file(lua_State* L) {
  lua_pushliteral(L, "file");
  if (lua_rawget(L, 1) != LUA_TSTRING) return;  // the check of the tree says so
  const char* relative = lua_tostring(L, -1);
  guard(L, [&] {
    LuaSandbox& sandbox = LuaSandbox::of(L);
    load_named_plugin(beside(sandbox.file(), relative), sandbox.place(L),
                      *sandbox.reading->registry);
  });
}

}  // namespace

int construct(lua_State* L, const char* tag) {
  LuaSandbox& sandbox = LuaSandbox::of(L);
  if (!sandbox.reading) refuse(L, "elements cannot be made inside a plugin's function");
  if (!lua_istable(L, 1) || lua_gettop(L) != 1)
    guard(L, [&] {
      throw InputError(sandbox.place(L), fmt::format("{} is called without a table", tag),
                       fmt::format("{} {{ name = \"...\", ... }}", tag));
    });
  lua_rawgetp(L, LUA_REGISTRYINDEX, &tags_key);
  lua_pushvalue(L, 1);
  if (lua_rawget(L, -2) == LUA_TSTRING && std::strcmp(lua_tostring(L, -1), tag) != 0)
    refuse(L, "this table is an element already", "a table of its own for each element");
  lua_pushvalue(L, 1);
  lua_pushstring(L, tag);
  lua_rawset(L, -4);
  lua_rawgetp(L, LUA_REGISTRYINDEX, &lines_key);
  lua_pushvalue(L, 1);
  int line = 0;
  guard(L, [&] { line = sandbox.place(L).line; });
  lua_pushinteger(L, line);
  lua_rawset(L, -3);
  if (std::strcmp(tag, "plugin") == 0) load_plugin_file(L);
  lua_settop(L, 1);
  return 1;
}

void install_elements(lua_State* L) {
  for (const char* key : {&tags_key, &lines_key}) {
    lua_newtable(L);
    lua_rawsetp(L, LUA_REGISTRYINDEX, key);
  }
  lua_rawgeti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
  lua_createtable(L, 0, 1);
  lua_pushcfunction(L, missing_global);
  lua_setfield(L, -2, "__index");
  lua_setmetatable(L, -2);
  lua_pop(L, 1);
}

const char* tag_of(lua_State* L, int table) {
  table = lua_absindex(L, table);
  lua_rawgetp(L, LUA_REGISTRYINDEX, &tags_key);
  lua_pushvalue(L, table);
  lua_rawget(L, -2);
  const char* tag = lua_tostring(L, -1);  // kept alive by the table of tags
  lua_pop(L, 2);
  return tag;
}

int line_of(lua_State* L, int table) {
  table = lua_absindex(L, table);
  lua_rawgetp(L, LUA_REGISTRYINDEX, &lines_key);
  lua_pushvalue(L, table);
  lua_rawget(L, -2);
  const int line = static_cast<int>(lua_tointeger(L, -1));
  lua_pop(L, 2);
  return line;
}

}  // namespace talus::lua
