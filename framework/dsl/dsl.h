// Reading and writing model files. XML and Lua give the same Model; what cannot be read ends in one
// InputError with the place in the file.
#pragma once

#include <string>

#include "framework/model/model.h"
#include "framework/registry/registry.h"

namespace talus {

// Reads a model by its ending, .xml or .lua. Included files take the place of their <include>.
// Plugins that the file brings along (a <plugin file="x.lua"/> element, or definitions inside a Lua
// model) are added to `registry`. The whole is checked with check_grammar. The place of an
// attribute is that of its value's first character; columns count characters.
//
// A Lua model that defines plugins gets a `plugin` element naming the file itself, so that models
// made from it (converted, calibrated), which are data only, still find its plugins.
Model read_model(const std::string& file, Registry& registry);

// The same from text; `name` stands for the file in messages and for relative paths.
Model read_xml(const std::string& text, const std::string& name, Registry& registry);
Model read_lua(const std::string& text, const std::string& name, Registry& registry);

// The model as text in either syntax; reading it back gives the same model.
std::string write_xml(const Model& model);
std::string write_lua(const Model& model);

// Rewrites the relative paths of `plugin` elements, which hold beside the file `from`, so that they
// hold beside the file `to`. To be called before a model is written elsewhere.
void move_plugin_paths(Model& model, const std::string& from, const std::string& to);

// Loads a plugin file the user named: .so or .lua. A file that is loaded already is left as it is.
void load_plugin(const std::string& file, Registry& registry);

// Checks the tree against the grammar: known tags, known attributes with the nearest valid name,
// required attributes, children where they may stand, unique names.
void check_grammar(const Model& model, const Registry& registry);

// An XML schema (XSD) of everything registered.
std::string xml_schema(const Registry& registry);

}  // namespace talus
