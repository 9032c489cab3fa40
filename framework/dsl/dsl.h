// Reading and writing model files. XML and Lua give the same Model; what cannot be read ends in one
// InputError with the place in the file.
#pragma once

#include <string>

#include "framework/model/model.h"
#include "framework/registry/registry.h"

namespace talus {

// Reads a model by its ending, .xml or .lua. Plugins that the file brings along (a <plugin file="x.lua"/>
// element, or definitions inside a Lua model) are added to `registry`. Tags and attributes are
// checked against the registry (see check.h).
Model read_model(const std::string& file, Registry& registry);

// The same from text; `name` stands for the file in messages and for relative paths.
Model read_xml(const std::string& text, const std::string& name, Registry& registry);
Model read_lua(const std::string& text, const std::string& name, Registry& registry);

// The model as text in either syntax; reading it back gives the same model.
std::string write_xml(const Model& model);
std::string write_lua(const Model& model);

// Loads a plugin file the user named: .so or .lua.
void load_plugin(const std::string& file, Registry& registry);

// Checks the tree against the grammar: known tags, known attributes with the nearest valid name,
// required attributes, children where they may stand, unique names.
void check_grammar(const Model& model, const Registry& registry);

// An XML schema (XSD) of everything registered.
std::string xml_schema(const Registry& registry);

}  // namespace talus
