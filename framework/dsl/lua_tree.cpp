#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/dsl/grammar.h"
#include "framework/dsl/lua_elements.h"
#include "framework/dsl/lua_sandbox.h"
#include "framework/dsl/lua_source.h"
#include "framework/dsl/lua_words.h"
#include "framework/dsl/text.h"
#include "framework/model/quantity.h"

namespace talus::lua {
namespace {

constexpr int deepest = 100;
constexpr int most_elements = 100'000;
constexpr std::size_t longest_text = 10'000;

class TreeReader {
 public:
  TreeReader(lua_State* L, const std::string& text)
      : L_(L), file_(LuaSandbox::of(L).file()), source_(text, file_) {}

  // The value on top of the stack, which must be an element.
  Element root() {
    const char* tag = tag_of(L_, -1);
    if (!tag)
      throw InputError({file_, 0, 0},
                       lua_isnil(L_, -1)
                           ? "the file returns nothing"
                           : fmt::format("the file returns a {}", luaL_typename(L_, -1)),
                       "return talus { ... } as its last statement");
    return element(tag, 0);
  }

 private:
  Element element(const char* tag, int depth) {
    const int table = lua_gettop(L_), line = line_of(L_, table);
    const Place here{file_, line, 0};
    if (depth > deepest || !lua_checkstack(L_, 10))
      throw InputError(here, "elements are nested too deeply", "no element inside itself");
    if (++count_ > most_elements)
      throw InputError(here, fmt::format("more than {} elements", most_elements));
    Element e{tag};
    for (lua_pushnil(L_); lua_next(L_, table); lua_pop(L_, 1))
      if (lua_type(L_, -2) == LUA_TSTRING) attribute(e, here);
    sort_attributes(e);
    source_.locate(e, line);
    sort_as_written(e);
    for (Attribute& a : e.attributes) check_text(a);
    children(table, e.children, here, depth);
    return e;
  }

  // The attribute at key -2 and value -1 of the stack.
  void attribute(Element& e, const Place& here) {
    const std::string name = attribute_of_lua_key(lua_tostring(L_, -2));
    std::string text;
    switch (lua_type(L_, -1)) {
      case LUA_TSTRING: {
        std::size_t size;
        const char* start = lua_tolstring(L_, -1, &size);
        text.assign(start, std::min(size, longest_text + 1));
        break;
      }
      case LUA_TNUMBER:
        if (!std::isfinite(lua_tonumber(L_, -1)))
          wrong(e, name, here, fmt::format("{}", lua_tonumber(L_, -1)), "a finite number");
        text = lua_isinteger(L_, -1) ? std::to_string(lua_tointeger(L_, -1))
                                     : shortest(lua_tonumber(L_, -1));
        break;
      default:
        if (const char* tag = lua_istable(L_, -1) ? tag_of(L_, -1) : nullptr)
          wrong(e, name, here, fmt::format("the element <{}>", tag),
                "the element alone, without a key");
        wrong(e, name, here, fmt::format("a {}", luaL_typename(L_, -1)), "text or a number");
    }
    if (e.find(name)) wrong(e, name, here, "given twice", "it once");
    e.attributes.push_back({name, text, here});
  }

  // Places an error at the attribute, which is no part of the element yet.
  [[noreturn]] void wrong(Element e, const std::string& name, const Place& here,
                          const std::string& found, const std::string& expected) const {
    e.attributes.push_back({name, "", here});
    source_.locate(e, here.line);
    throw InputError(e.attributes.back().place,
                     fmt::format("'{}' of <{}> is {}", name, e.tag, found), expected);
  }

  static void check_text(const Attribute& a) {
    if (a.text.size() > longest_text)
      throw InputError(a.place,
                       fmt::format("'{}' is longer than {} characters", a.name, longest_text));
    if (!is_utf8(a.text)) throw InputError(a.place, fmt::format("'{}' is not UTF-8 text", a.name));
  }

  // Where the text shows all attributes, their order there is kept.
  static void sort_as_written(Element& e) {
    const auto at = [](const Attribute& a) { return std::pair(a.place.line, a.place.column); };
    const auto own = std::pair(e.place.line, e.place.column);
    if (std::all_of(e.attributes.begin(), e.attributes.end(),
                    [&](const Attribute& a) { return at(a) > own; }))
      std::sort(e.attributes.begin(), e.attributes.end(),
                [&](const Attribute& a, const Attribute& b) { return at(a) < at(b); });
  }

  // Lua forgets the order of keys; the declared one is used, `name` first.
  void sort_attributes(Element& e) const {
    std::vector<std::string> order;
    if (const auto* reading = LuaSandbox::of(L_).reading)
      if (const auto rule = rule_of(e.tag, *reading->registry)) order = rule->names();
    const auto rank = [&](const Attribute& a) {
      return std::pair(
          a.name == "name" ? -1 : std::find(order.begin(), order.end(), a.name) - order.begin(),
          a.name);
    };
    std::sort(e.attributes.begin(), e.attributes.end(),
              [&](const Attribute& a, const Attribute& b) { return rank(a) < rank(b); });
  }

  // The array part of a table in order, plain lists in it flattened; nil and false are no children,
  // so that `condition and dh { ... }` may stand there.
  void children(int table, std::vector<Element>& to, const Place& here, int depth) {
    std::vector<lua_Integer> keys;
    for (lua_pushnil(L_); lua_next(L_, table); lua_pop(L_, 1))
      if (lua_isinteger(L_, -2))
        keys.push_back(lua_tointeger(L_, -2));
      else if (lua_type(L_, -2) != LUA_TSTRING)
        throw InputError(here, fmt::format("a key of this table is a {}", luaL_typename(L_, -2)),
                         "attributes (key = value) and elements");
    std::sort(keys.begin(), keys.end());
    for (lua_Integer key : keys) {
      lua_rawgeti(L_, table, key);
      child(to, here, depth);
      lua_pop(L_, 1);
    }
  }

  void child(std::vector<Element>& to, const Place& here, int depth) {
    if (lua_isboolean(L_, -1) && !lua_toboolean(L_, -1)) return;
    if (!lua_istable(L_, -1))
      throw InputError(here,
                       fmt::format("a {} stands where elements belong", luaL_typename(L_, -1)),
                       "attributes (key = value) and elements (tag { ... })");
    if (const char* tag = tag_of(L_, -1)) {
      to.push_back(element(tag, depth + 1));
      return;
    }
    if (depth > deepest || !lua_checkstack(L_, 10))
      throw InputError(here, "lists are nested too deeply", "no list inside itself");
    if (++count_ > most_elements)
      throw InputError(here, fmt::format("more than {} elements and lists", most_elements));
    const int table = lua_gettop(L_);
    for (lua_pushnil(L_); lua_next(L_, table); lua_pop(L_, 1))
      if (lua_type(L_, -2) == LUA_TSTRING)
        throw InputError(here,
                         fmt::format("a table with '{} = ...' has no tag", lua_tostring(L_, -2)),
                         "tag { ... }, or a plain list of elements");
    children(table, to, here, depth + 1);
  }

  lua_State* L_;
  std::string file_;
  LuaSource source_;
  int count_ = 0;
};

}  // namespace

Element read_tree(lua_State* L, const std::string& text) { return TreeReader(L, text).root(); }

}  // namespace talus::lua
