// Which of Lua's own libraries a model file may use.
#pragma once

#include <lua.hpp>

namespace talus {

// Makes the globals of a sandbox; runs protected.
void install_libraries(lua_State* L);

}  // namespace talus
