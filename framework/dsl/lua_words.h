// How attributes are spelled as Lua keys. A word of the Lua language cannot stand before `=`, so it
// gets a trailing underscore: `frame { name = "E", in_ = "B" }`. Other odd names go in brackets.
#pragma once

#include <string>
#include <string_view>

namespace talus {

bool is_lua_keyword(std::string_view word);
std::string lua_key(std::string_view attribute);         // in -> in_, xml:id -> ["xml:id"]
std::string attribute_of_lua_key(std::string_view key);  // in_ -> in

}  // namespace talus
