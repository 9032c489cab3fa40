// What is particular to effects written in Lua: the fields of their definitions, the circumstances
// that their function gets and the numbers that it returns. See lua_plugin.h for an example.
#pragma once

#include <lua.hpp>

#include <string>
#include <vector>

#include "framework/model/error.h"
#include "framework/registry/plugin.h"

namespace talus::lua {

// Reads the fields of an effect's definition that are no inputs. Nothing here raises a Lua error.
class LuaEffect {
 public:
  LuaEffect(lua_State* L, int table, Declaration& declaration, const Place& place)
      : L_(L), table_(table), d_(declaration), place_(place) {}

  static const std::vector<std::string>& fields();
  // Takes the field whose value is on top of the stack; false where effects have no such field.
  bool field(const std::string& name);
  void finish();  // after all inputs and fields: what is missing, forms

 private:
  [[noreturn]] void fail(const std::string& found, const std::string& expected = {},
                         const std::string& suggestion = {}) const;
  std::vector<std::string> words(const std::string& name) const;
  bool flag(const std::string& name) const;
  std::string text(const std::string& name) const;

  lua_State* L_;
  int table_;
  Declaration& d_;
  Place place_;
  bool has_acts_ = false;
};

// Pushes a table of what the effect asks for. May raise a Lua error, as those below.
void push_around(lua_State* L, const Around<Expr>& around, const EffectTraits& effect);

// The value on top of the stack as numbers, 1, 6 or 9 of them, which are zero so far. Where it is
// something else: what is expected; the wrong value is on top of the stack then.
const char* read_act(lua_State* L, std::vector<Expr>& numbers);

}  // namespace talus::lua
