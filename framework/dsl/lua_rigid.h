// Rigid transforms in Lua; see lua_traced.h.
#pragma once

#include <lua.hpp>

namespace talus::lua {

void install_rigid(lua_State* L);
lua_Integer trace_number(lua_State* L);  // of the call being traced; 0 outside

}  // namespace talus::lua
