// Calls of a Lua plugin's functions with traced numbers.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "framework/dsl/lua_effect.h"
#include "framework/dsl/lua_plugin.h"
#include "framework/dsl/lua_sandbox.h"
#include "framework/dsl/lua_traced.h"

namespace talus::lua {
namespace {

// One call; it outlives the protected call, which gets a pointer to it.
struct Call {
  const Declaration& declaration;
  int definition;
  Plugin::Inputs inputs;
  Plugin::Choices choices;
  const Expr* reading = nullptr;
  const Rigid<Expr>* model = nullptr;
  const Observed<Expr>* measured = nullptr;
  const Around<Expr>* around = nullptr;
  Expr value = {};
  Rigid<Expr> transform = {};
  std::vector<Expr> rows = {};
  int line = 0;  // of the function
};

// __index of the table of inputs.
int missing_input(lua_State* L) {
  const char* name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "?";
  guard(L, [&] {
    std::vector<std::string> known;
    for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1))
      if (lua_type(L, -2) == LUA_TSTRING) known.push_back(lua_tostring(L, -2));
    std::sort(known.begin(), known.end());
    throw InputError(LuaSandbox::of(L).place(L), fmt::format("'{}' is not among the inputs", name),
                     known.empty() ? "" : "one of: " + join(known), nearest(name, known));
  });
  return 0;
}

void push_inputs(lua_State* L, const Call& call) {
  const Declaration& d = call.declaration;
  lua_createtable(L, 0, static_cast<int>(d.inputs.size() + d.choices.size()));
  for (std::size_t i = 0; i < d.inputs.size(); ++i) {
    push_traced(L, call.inputs[i]);
    lua_setfield(L, -2, d.inputs[i].name.c_str());
  }
  for (std::size_t i = 0; i < d.choices.size(); ++i) {
    lua_pushstring(L, d.choices[i].words[call.choices[i]].c_str());
    lua_setfield(L, -2, d.choices[i].name.c_str());
  }
  lua_createtable(L, 0, 1);
  lua_pushcfunction(L, missing_input);
  lua_setfield(L, -2, "__index");
  lua_setmetatable(L, -2);
}

void push_transform(lua_State* L, const Rigid<Expr>& value) {
  Rigid<Expr>* copy = push_rigid(L);
  guard(L, [&] { *copy = value; });
}

const char* word(Kind kind) {
  static constexpr const char* words[] = {"frame", "point", "direction", "scalar", "closure"};
  return words[static_cast<int>(kind)];
}

void push_measured(lua_State* L, const Observed<Expr>& measured) {
  lua_createtable(L, 0, 5);
  lua_pushstring(L, word(measured.kind));
  lua_setfield(L, -2, "kind");
  push_transform(L, measured.frame);
  lua_setfield(L, -2, "frame");
  push_traced(L, measured.scalar);
  lua_setfield(L, -2, "scalar");
  lua_pushboolean(L, measured.angles);
  lua_setfield(L, -2, "angles");
  static constexpr const char* axes[] = {"x", "y", "z"};
  lua_createtable(L, 0, 3);
  for (int i = 0; i < 3; ++i) {
    push_traced(L, measured.vector[i]);
    lua_setfield(L, -2, axes[i]);
  }
  lua_setfield(L, -2, "vector");
}

// Refuses the value on top of the stack as a result.
[[noreturn]] void wrong_result(lua_State* L, const Call& call, const char* expected) {
  const char* found = luaL_typename(L, -1);
  if (lua_istable(L, -1))
    found = lua_pushfstring(L, "table of %d", static_cast<int>(lua_rawlen(L, -1)));
  else if (luaL_getmetafield(L, -1, "__name") == LUA_TSTRING)
    found = lua_tostring(L, -1);
  guard(L, [&] {
    const Declaration& d = call.declaration;
    throw InputError(
        {LuaSandbox::of(L).file(), call.line, 0},
        fmt::format("{} '{}': its function returns a {}", to_string(d.family), d.tag, found),
        expected);
  });
  std::abort();  // guard has raised
}

void take_rows(lua_State* L, Call& call) {
  const std::size_t wanted = call.declaration.columns.size();
  if (!lua_istable(L, -1) || lua_rawlen(L, -1) != wanted) {
    const char* expected =
        lua_pushfstring(L, "a table of %d numbers, one for each row", static_cast<int>(wanted));
    lua_insert(L, -2);
    wrong_result(L, call, expected);
  }
  guard(L, [&] { call.rows.resize(wanted); });
  for (std::size_t i = 0; i < wanted; ++i) {
    lua_rawgeti(L, -1, static_cast<lua_Integer>(i + 1));
    if (!to_expr(L, -1, call.rows[i])) wrong_result(L, call, "a table of numbers");
    lua_pop(L, 1);
  }
}

void take_act(lua_State* L, Call& call) {
  guard(L, [&] { call.rows.assign(parts_of(call.declaration.effect.acts), Expr(0)); });
  if (const char* expected = read_act(L, call.rows)) wrong_result(L, call, expected);
}

// Runs protected; `data` is the Call.
int perform(lua_State* L) {
  Call& call = *static_cast<Call*>(lua_touserdata(L, 1));
  begin_trace(L);
  luaL_checkstack(L, 20, nullptr);
  lua_rawgeti(L, LUA_REGISTRYINDEX, call.definition);
  const Family family = call.declaration.family;
  lua_getfield(L, -1, family == Family::joint ? "transform" : "value");
  lua_Debug function;
  lua_pushvalue(L, -1);
  lua_getinfo(L, ">S", &function);
  call.line = function.linedefined;
  int arguments = 1;
  if (call.reading) {
    push_traced(L, *call.reading);
    ++arguments;
  }
  if (call.model) {
    push_transform(L, *call.model);
    push_measured(L, *call.measured);
    arguments += 2;
  }
  if (call.around) {
    push_around(L, *call.around, call.declaration.effect);
    ++arguments;
  }
  push_inputs(L, call);
  lua_call(L, arguments, 1);
  if (family == Family::joint) {
    const Rigid<Expr>* result = to_rigid(L, -1);
    if (!result) wrong_result(L, call, "a transform such as rotate_z(p.theta) * translate_x(p.a)");
    guard(L, [&] { call.transform = *result; });
  } else if (family == Family::sensor) {
    if (!to_expr(L, -1, call.value)) wrong_result(L, call, "a number such as p.slope * reading");
  } else if (family == Family::effect) {
    take_act(L, call);
  } else {
    take_rows(L, call);
  }
  return 0;
}

// A plugin's hold on its definition, which keeps the Lua state alive.
struct Bound {
  std::shared_ptr<LuaSandbox> sandbox;
  Declaration declaration;
  int definition;

  void run(Call& call) const {
    try {
      sandbox->protect(&perform, &call);
    } catch (const InputError& e) {
      if (e.place().line > 0) throw;
      throw moved(e, {sandbox->file(), call.line, 0});
    }
  }
};

}  // namespace

void bind_lua(Plugin& plugin, LuaSandbox& sandbox, int definition) {
  auto bound =
      std::make_shared<Bound>(Bound{sandbox.shared_from_this(), plugin.declaration, definition});
  using In = Plugin::Inputs;
  using Ch = Plugin::Choices;
  switch (plugin.declaration.family) {
    case Family::joint:
      plugin.transform = [bound](In in, Ch ch) {
        Call call{bound->declaration, bound->definition, in, ch};
        bound->run(call);
        return std::move(call.transform);
      };
      break;
    case Family::sensor:
      plugin.value = [bound](const Expr& reading, In in, Ch ch) {
        Call call{bound->declaration, bound->definition, in, ch, &reading};
        bound->run(call);
        return call.value;
      };
      break;
    case Family::effect:
      plugin.act = [bound](const Around<Expr>& around, In in, Ch ch) {
        Call call{
            bound->declaration, bound->definition, in, ch, nullptr, nullptr, nullptr, &around};
        bound->run(call);
        return std::move(call.rows);
      };
      break;
    default:
      plugin.rows = [bound](const Rigid<Expr>& model, const Observed<Expr>& measured, In in,
                            Ch ch) {
        Call call{bound->declaration, bound->definition, in, ch, nullptr, &model, &measured};
        bound->run(call);
        return std::move(call.rows);
      };
  }
}

}  // namespace talus::lua
