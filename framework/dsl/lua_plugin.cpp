#include "framework/dsl/lua_plugin.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>

#include "framework/dsl/grammar.h"
#include "framework/dsl/lua_effect.h"
#include "framework/dsl/lua_sandbox.h"
#include "framework/registry/registry.h"

namespace talus::lua {
namespace {

constexpr std::size_t most_plugins = 1000;

using Words = std::vector<std::string>;

std::string text_at(lua_State* L, int index) {
  return lua_type(L, index) == LUA_TSTRING ? lua_tostring(L, index) : "";
}

// Reads a definition's table into a declaration. C++ inside guard(): nothing here raises.
class DefinitionReader {
 public:
  DefinitionReader(lua_State* L, int table, Family family, const char* tag)
      : L_(L), table_(table), place_(LuaSandbox::of(L).place(L)) {
    d_.family = family;
    d_.tag = tag;
    d_.lua = true;
    if (family == Family::residual) d_.kinds = {Kind::frame};
    if (family == Family::effect) traits_ = std::make_unique<LuaEffect>(L, table, d_, place_);
  }

  Declaration read() {
    if (is_structural(d_.tag)) fail("its tag is that of a part of every model", "another tag");
    std::map<lua_Integer, std::string> inputs;  // by order of creation
    for (lua_pushnil(L_); lua_next(L_, table_); lua_pop(L_, 1)) {
      if (lua_type(L_, -2) != LUA_TSTRING)
        fail(fmt::format("a {} stands without a name", luaL_typename(L_, -1)), "name = value");
      const std::string name = lua_tostring(L_, -2);
      if (const InputSpec* input = input_at(L_, -1))
        inputs[input->order] = name;
      else
        field(name);
    }
    for (const auto& [order, name] : inputs) {
      for (lua_pushnil(L_); lua_next(L_, table_); lua_pop(L_, 1))
        if (const InputSpec* input = input_at(L_, -1); input && input->order == order)
          add(name, *input);
    }
    if (d_.summary.empty()) d_.summary = to_string(d_.family) + " defined in " + place_.file;
    if (d_.family == Family::residual && d_.columns.empty())
      fail("no rows are declared", "rows = { \"x\", length, \"y\", length }");
    if (traits_) traits_->finish();
    if (!has_function_)
      fail(fmt::format("there is no {}", function()),
           fmt::format("{} = function(...) ... end", function()));
    return d_;
  }

 private:
  [[noreturn]] void fail(const std::string& found, const std::string& expected = {},
                         const std::string& suggestion = {}) const {
    throw InputError(place_, fmt::format("{} '{}': {}", to_string(d_.family), d_.tag, found),
                     expected, suggestion);
  }

  std::string function() const { return d_.family == Family::joint ? "transform" : "value"; }

  // A field that is no input; its value is on top of the stack.
  void field(const std::string& name) {
    if (name == "summary" && lua_type(L_, -1) == LUA_TSTRING)
      d_.summary = lua_tostring(L_, -1);
    else if (name == function() && lua_isfunction(L_, -1))
      has_function_ = true;
    else if (d_.family == Family::sensor && name == "reading")
      d_.reading = dimension(name);
    else if (d_.family == Family::sensor && name == "gives")
      d_.value = dimension(name);
    else if (d_.family == Family::residual && name == "rows")
      rows();
    else if (d_.family == Family::residual && name == "of")
      kinds();
    else if (traits_ && traits_->field(name))
      return;
    else if (dimension_at(L_, -1))
      fail(fmt::format("'{}' is a dimension without a default", name),
           fmt::format("{} = length(0), {} = length() where it must be given, or the like", name,
                       name));
    else
      unknown(name);
  }

  [[noreturn]] void unknown(const std::string& name) const {
    Words known{"summary", function()};
    if (d_.family == Family::sensor) known.insert(known.end(), {"reading", "gives"});
    if (d_.family == Family::residual) known.insert(known.end(), {"of", "rows"});
    if (traits_) known.insert(known.end(), LuaEffect::fields().begin(), LuaEffect::fields().end());
    fail(fmt::format("'{}' is a {}", name, luaL_typename(L_, -1)),
         fmt::format("an input such as {}, or one of: ",
                     traits_ ? "amount(angle, \"0.02 deg\")" : "length(0)") +
             join(known),
         nearest(name, known));
  }

  Dimension dimension(const std::string& what) const {
    const Dimension* d = dimension_at(L_, -1);
    if (!d)
      fail(fmt::format("'{}' is a {}", what, luaL_typename(L_, -1)),
           "length, angle, number, unit(\"N*m\")");
    return *d;
  }

  // Calls f with each value of the list on top of the stack, which stands at index -1 then.
  template <class F>
  void each(const std::string& what, F f) {
    if (!lua_istable(L_, -1))
      fail(fmt::format("'{}' is a {}", what, luaL_typename(L_, -1)), "a list { ... }");
    const lua_Integer size =
        static_cast<lua_Integer>(std::min<lua_Unsigned>(lua_rawlen(L_, -1), 1000));
    for (lua_Integer i = 1; i <= size; ++i) {
      lua_rawgeti(L_, -1, i);
      f();
      lua_pop(L_, 1);
    }
  }

  void rows() {  // { "x", length, "y", length }
    std::string name;
    each("rows", [&] {
      if (name.empty()) {
        name = text_at(L_, -1);
        if (name.empty()) fail("a row has no name", "rows = { \"x\", length, \"y\", length }");
      } else {
        d_.row(name, dimension(name));
        name.clear();
      }
    });
    if (!name.empty())
      fail(fmt::format("row '{}' has no dimension", name),
           "rows = { \"x\", length, \"y\", length }");
  }

  void kinds() {
    static const std::map<std::string, Kind> known = {{"frame", Kind::frame},
                                                      {"point", Kind::point},
                                                      {"direction", Kind::direction},
                                                      {"scalar", Kind::scalar},
                                                      {"closure", Kind::nothing}};
    d_.kinds.clear();
    each("of", [&] {
      const std::string word = text_at(L_, -1);
      if (!known.count(word))
        fail(fmt::format("nothing of kind '{}' is measured", word),
             "one of: frame, point, direction, scalar, closure");
      d_.kinds.push_back(known.at(word));
    });
  }

  // The input on top of the stack.
  void add(const std::string& name, const InputSpec& input) {
    if (is_reserved(name, d_.family))
      fail(fmt::format("'{}' is an attribute of every {}", name, to_string(d_.family)),
           "another name for this input");
    if (!input.choice && (input.role == Role::plain) == (d_.family == Family::effect))
      fail(fmt::format("'{}' is {}", name,
                       traits_ ? "neither an amount nor a setting" : "an amount or a setting"),
           traits_
               ? "amount(angle, \"0.02 deg\"), zero where nothing is wrong, or setting(number, 8)"
               : "length(0) or the like; amounts are those of effects");
    lua_getiuservalue(L_, -1, 1);
    std::string meaning = text_at(L_, -1);
    lua_pop(L_, 1);
    if (meaning.empty()) meaning = "defined in " + place_.file;
    if (input.choice) {
      Words words;
      lua_getiuservalue(L_, -1, 2);
      each(name, [&] { words.push_back(text_at(L_, -1)); });
      lua_pop(L_, 1);
      if (words.empty() || std::find(words.begin(), words.end(), "") != words.end())
        fail(fmt::format("the choice '{}' needs its words", name),
             "choice({\"one\", \"two\"}, \"meaning\")");
      d_.choice(name, words, meaning);
    } else if (input.role == Role::amount) {
      d_.amount(name, input.dimension, input.typical, meaning);
    } else if (input.role == Role::setting) {
      std::vector<double> tries;
      lua_getiuservalue(L_, -1, 2);
      if (lua_istable(L_, -1)) each(name, [&] { tries.push_back(lua_tonumber(L_, -1)); });
      lua_pop(L_, 1);
      d_.setting(name, input.dimension, input.otherwise, tries, meaning);
    } else if (input.coordinate) {
      d_.coordinate(name, input.dimension, meaning);
    } else if (input.required) {
      d_.required(name, input.dimension, meaning);
    } else {
      d_.input(name, input.dimension, input.otherwise, meaning);
    }
  }

  lua_State* L_;
  int table_;
  Place place_;
  Declaration d_;
  bool has_function_ = false;
  std::unique_ptr<LuaEffect> traits_;  // of effects
};

// Adds the plugin to the registry; what the registry refuses is said with the line.
void add_plugin(lua_State* L, Declaration declaration, int definition) {
  LuaSandbox& sandbox = LuaSandbox::of(L);
  auto& [registry, defined] = *sandbox.reading;
  const std::string tag = declaration.tag;
  const bool twice = std::find(defined.begin(), defined.end(), tag) != defined.end();
  if (defined.size() == most_plugins)
    throw InputError(sandbox.place(L),
                     fmt::format("more than {} plugins in one file", most_plugins));
  defined.push_back(tag);
  if (const Plugin* known = registry->find(tag, declaration.family);
      known && known->origin == sandbox.file() && !twice)
    return;  // the file is read again
  Plugin plugin{.declaration = std::move(declaration)};
  plugin.origin = sandbox.file();
  bind_lua(plugin, sandbox, definition);
  try {
    registry->add(std::move(plugin));
  } catch (const InputError& e) {
    throw moved(e, sandbox.place(L));
  }
}

// `joint "tag"` is a function that takes the definition.
int define(lua_State* L) {  // upvalues: the family, the tag
  if (!LuaSandbox::of(L).reading) refuse(L, "plugins cannot be defined inside a plugin's function");
  if (!lua_istable(L, 1))
    refuse(L, "a plugin's definition is not a table",
           "joint \"tag\" { input = length(0), transform = function(p) ... end }");
  luaL_checkstack(L, 20, nullptr);
  const Family family = static_cast<Family>(lua_tointeger(L, lua_upvalueindex(1)));
  const char* tag = lua_tostring(L, lua_upvalueindex(2));
  lua_pushvalue(L, 1);
  const int definition = luaL_ref(L, LUA_REGISTRYINDEX);
  guard(L, [&] { add_plugin(L, DefinitionReader(L, 1, family, tag).read(), definition); });
  return 0;
}

int name_definition(lua_State* L) {  // upvalue: the family
  if (lua_type(L, 1) != LUA_TSTRING)
    refuse(L, "a plugin's definition begins without its tag",
           "joint \"tag\" { ... }, likewise sensor, residual and effect");
  lua_rawgeti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
  lua_pushvalue(L, 1);
  if (lua_rawget(L, -2) != LUA_TNIL && !lua_iscfunction(L, -1))
    refuse(L, "the tag is the name of a variable", "a tag of its own");
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_pushvalue(L, 1);
  lua_pushcclosure(L, &define, 2);
  return 1;
}

}  // namespace

void install_definitions(lua_State* L) {
  install_inputs(L);
  static constexpr std::pair<const char*, Family> families[] = {{"joint", Family::joint},
                                                                {"sensor", Family::sensor},
                                                                {"residual", Family::residual},
                                                                {"effect", Family::effect}};
  for (const auto& [name, family] : families) {
    lua_pushinteger(L, static_cast<int>(family));
    lua_pushcclosure(L, &name_definition, 1);
    lua_setglobal(L, name);
  }
}

}  // namespace talus::lua
