// Elements in Lua: `dh { name = "joint1", a = 300 }` marks its table as an element of that tag,
// made on that line. The tree is read off the tables when the file has run.
#pragma once

#include <lua.hpp>
#include <string>

#include "framework/model/model.h"

namespace talus::lua {

// Makes every tag a constructor; other unknown globals become errors. Runs protected.
void install_elements(lua_State* L);

// Marks the table at stack index 1 as an element and leaves it on top. May raise.
int construct(lua_State* L, const char* tag);

// The tree of the value on top of the stack of the sandbox; `text` is the file's. No protected call
// is needed: nothing here makes Lua allocate.
Element read_tree(lua_State* L, const std::string& text);

// Of a table; null where it is no element. Neither raises.
const char* tag_of(lua_State* L, int table);
int line_of(lua_State* L, int table);

}  // namespace talus::lua
