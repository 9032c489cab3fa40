// How the readers of the two syntaxes work together: each turns text into a tree as written, and
// what they share (includes, plugin files, the check) is done on the tree.
#pragma once

#include <string>

#include "framework/model/model.h"
#include "framework/registry/registry.h"

namespace talus {

Element parse_xml(const std::string& text, const std::string& file);

// Runs a Lua model. Plugins defined in it, and plugin files it names, are added to `registry`;
// where it defines some, a `plugin` element that names the file itself comes first among the
// children, so that whatever is written from this model finds them again.
Element run_lua_model(const std::string& text, const std::string& file, Registry& registry);

// Runs a Lua file for the plugins it defines.
void run_lua_plugins(const std::string& text, const std::string& file, Registry& registry);

// Loads the Lua plugin file that a <plugin file="..."/> at `place` names, unless it is loaded.
void load_named_plugin(const std::string& file, const Place& place, Registry& registry);

}  // namespace talus
