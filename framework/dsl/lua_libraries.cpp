#include "framework/dsl/lua_libraries.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <string_view>

#include <fmt/format.h>

#include "framework/dsl/lua_sandbox.h"

namespace talus {
namespace {

struct Library {
  const char* name;
  lua_CFunction open;
  std::array<const char*, 28> keep;  // filled up with null
};

// Left out are files, code, the state's machinery, metatables, random numbers, addresses, and what
// can run without end between two steps: patterns and table.move.
constexpr Library libraries[] = {
    {LUA_GNAME,
     luaopen_base,
     {"assert", "error", "ipairs", "select", "tonumber", "tostring", "type"}},
    {LUA_MATHLIBNAME,
     luaopen_math,
     {"abs",  "acos", "asin", "atan", "ceil",       "cos",  "deg",        "exp",  "floor",
      "fmod", "huge", "log",  "max",  "maxinteger", "min",  "mininteger", "modf", "pi",
      "rad",  "sin",  "sqrt", "tan",  "tointeger",  "type", "ult"}},
    {LUA_TABLIBNAME, luaopen_table, {"concat", "insert", "pack", "remove", "sort", "unpack"}},
    {LUA_STRLIBNAME,
     luaopen_string,
     {"byte", "char", "format", "len", "lower", "rep", "reverse", "sub", "upper"}},
    {LUA_UTF8LIBNAME, luaopen_utf8, {"char", "codepoint", "codes", "len", "offset"}},
};

constexpr std::string_view forbidden[] = {
    "_G",      "_VERSION",     "collectgarbage", "coroutine",  "debug",  "dofile", "getmetatable",
    "io",      "load",         "loadfile",       "loadstring", "module", "next",   "os",
    "package", "pcall",        "print",          "rawequal",   "rawget", "rawlen", "rawset",
    "require", "setmetatable", "warn",           "xpcall"};

// __index of a library: what is not there was left out.
int missing_field(lua_State* L) {
  const char* library = lua_tostring(L, lua_upvalueindex(1));
  const char* field = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "?";
  guard(L, [&] {
    throw InputError(LuaSandbox::of(L).place(L),
                     fmt::format("'{}.{}' is not available in a model file", library, field));
  });
  return 0;
}

struct Key {
  int type;
  double number;
  const char* text;  // owned by the table
  std::size_t size;
  int index;  // in order of lua_next
};

bool before(const Key& a, const Key& b) {
  if (a.type != b.type) return a.type < b.type;  // numbers are before strings
  if (a.type == LUA_TNUMBER) return a.number < b.number;
  if (a.type == LUA_TSTRING)
    return std::string_view(a.text, a.size) < std::string_view(b.text, b.size);
  return a.index < b.index;
}

int next_key(lua_State* L) {  // upvalues: the table, its keys, how many were given
  for (lua_Integer i = lua_tointeger(L, lua_upvalueindex(3)) + 1;; ++i) {
    lua_pushinteger(L, i);
    lua_replace(L, lua_upvalueindex(3));
    if (lua_rawgeti(L, lua_upvalueindex(2), i) == LUA_TNIL) return 1;
    lua_pushvalue(L, -1);
    if (lua_rawget(L, lua_upvalueindex(1)) != LUA_TNIL) return 2;
    lua_pop(L, 2);  // removed meanwhile
  }
}

// pairs() in the order of the keys, whatever the order in memory: the same file, the same model.
int ordered_pairs(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  int count = 0;
  for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1)) ++count;
  auto* keys = static_cast<Key*>(lua_newuserdatauv(L, sizeof(Key) * (count + 1), 0));
  lua_createtable(L, count, 0);  // in order of lua_next
  int i = 0;
  for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1), ++i) {
    Key* key = new (keys + i) Key{lua_type(L, -2), 0, nullptr, 0, i + 1};
    if (key->type == LUA_TNUMBER) key->number = lua_tonumber(L, -2);
    if (key->type == LUA_TSTRING) key->text = lua_tolstring(L, -2, &key->size);
    lua_pushvalue(L, -2);
    lua_rawseti(L, 3, i + 1);
  }
  std::sort(keys, keys + count, before);
  LuaSandbox::of(L).charge(L, 10 * count);
  lua_pushvalue(L, 1);
  lua_createtable(L, count, 0);
  for (i = 0; i < count; ++i) {
    lua_rawgeti(L, 3, keys[i].index);
    lua_rawseti(L, -2, i + 1);
  }
  lua_pushinteger(L, 0);
  lua_pushcclosure(L, &next_key, 3);
  return 1;
}

}  // namespace

void install_libraries(lua_State* L) {
  lua_createtable(L, 0, 64);  // the globals
  const int globals = lua_gettop(L);
  for (const Library& library : libraries) {
    luaL_requiref(L, library.name, library.open, 0);
    const int whole = lua_gettop(L);
    const bool base = library.open == luaopen_base;
    if (base)
      lua_pushvalue(L, globals);
    else
      lua_createtable(L, 0, static_cast<int>(library.keep.size()));
    for (const char* name : library.keep)
      if (name) {
        lua_getfield(L, whole, name);
        lua_setfield(L, -2, name);
      }
    if (!base) {
      lua_createtable(L, 0, 1);
      lua_pushstring(L, library.name);
      lua_pushcclosure(L, &missing_field, 1);
      lua_setfield(L, -2, "__index");
      lua_setmetatable(L, -2);
      lua_pushvalue(L, -1);
      lua_setfield(L, globals, library.name);
    }
    if (library.open == luaopen_string) {  // ("x"):rep(3)
      lua_pushliteral(L, "");
      lua_getmetatable(L, -1);
      lua_pushvalue(L, -3);
      lua_setfield(L, -2, "__index");
    }
    lua_settop(L, globals);
  }
  lua_pushcfunction(L, &ordered_pairs);
  lua_setfield(L, globals, "pairs");
  lua_rawseti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
  lua_pushnil(L);
  lua_setfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
}

bool is_forbidden_in_lua(std::string_view global) {
  return std::find(std::begin(forbidden), std::end(forbidden), global) != std::end(forbidden);
}

}  // namespace talus
