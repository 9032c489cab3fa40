#include "framework/dsl/lua_traced.h"

#include <cmath>
#include <cstdint>
#include <new>

#include "framework/dsl/lua_rigid.h"
#include "framework/dsl/lua_sandbox.h"

namespace talus::lua {
namespace {

constexpr const char* kind = "traced number";
constexpr std::int32_t most_nodes = 1'000'000;  // recorded in one call
static_assert(std::is_trivially_destructible_v<Expr>);

struct Traced {
  Expr value;
  lua_Integer call;
};

const char trace_key = 0, nodes_key = 0;  // their addresses are keys of Lua's registry

Expr argument(lua_State* L, int index) {
  Expr value;
  if (!to_expr(L, index, value)) luaL_typeerror(L, index, "number");
  return value;
}

bool is_traced(lua_State* L, int index) { return luaL_testudata(L, index, kind) != nullptr; }

// The tape may not grow without an end either.
void check_size(lua_State* L, const Tape& tape) {
  lua_rawgetp(L, LUA_REGISTRYINDEX, &nodes_key);
  if (lua_isnil(L, -1)) {
    lua_pushinteger(L, tape.size());
    lua_rawsetp(L, LUA_REGISTRYINDEX, &nodes_key);
  } else if (tape.size() - lua_tointeger(L, -1) > most_nodes) {
    refuse(L, "more than a million operations are recorded");
  }
  lua_pop(L, 1);
}

int push_recorded(lua_State* L, Op op, const Expr& a, const Expr& b = {}, const Expr& c = {}) {
  Expr result;
  guard(L, [&] { result = record(op, a, b, c); });
  push_traced(L, result);
  return 1;
}

template <Op op>
int binary(lua_State* L) {
  const Expr a = argument(L, 1), b = argument(L, 2);
  return push_recorded(L, op, a, b);
}

int negate(lua_State* L) { return push_recorded(L, Op::neg, argument(L, 1)); }

int floor_division(lua_State* L) {
  push_recorded(L, Op::div, argument(L, 1), argument(L, 2));
  return push_recorded(L, Op::floor, argument(L, -1));
}

int modulo(lua_State* L) {  // a - floor(a / b) * b
  const Expr a = argument(L, 1), b = argument(L, 2);
  floor_division(L);
  push_recorded(L, Op::mul, argument(L, -1), b);
  return push_recorded(L, Op::sub, a, argument(L, -1));
}

int power(lua_State* L) {
  const Expr base = argument(L, 1), exponent = argument(L, 2);
  if (!exponent.is_constant())
    refuse(L, "the exponent of '^' is a traced number",
           "a constant exponent, or exp(x * log(a)) for a^x");
  const double n = exponent.constant();
  Expr result;
  guard(L, [&] {
    if (n == 0.5)
      result = sqrt(base);
    else if (n == std::floor(n) && std::abs(n) <= 64) {
      result = 1;
      for (int i = 0; i < std::abs(n); ++i) result = result * base;
      if (n < 0) result = 1 / result;
    } else
      result = exp(n * log(base));
  });
  push_traced(L, result);
  return 1;
}

int comparison(lua_State* L) {
  refuse(L, "traced numbers cannot be compared: their values are not known yet",
         "select(less(a, b), x, y), which is x where a < b and y elsewhere");
}

int to_text(lua_State* L) { return lua_pushstring(L, kind), 1; }

// A function of Lua's own (upvalue 1), or the recorded one where an argument is traced.
template <Op op>
int function(lua_State* L) {
  if (is_traced(L, 1) || is_traced(L, 2)) {
    const Expr a = argument(L, 1);
    if (op == Op::atan2)
      return push_recorded(L, op, a, lua_isnoneornil(L, 2) ? Expr(1) : argument(L, 2));
    if (op == Op::log && !lua_isnoneornil(L, 2)) {
      push_recorded(L, op, a);
      push_recorded(L, op, argument(L, 2));
      return push_recorded(L, Op::div, argument(L, -2), argument(L, -1));
    }
    return push_recorded(L, op, a);
  }
  luaL_checknumber(L, 1);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
  return lua_gettop(L);
}

int sign_function(lua_State* L) {
  const bool traced = is_traced(L, 1);
  push_recorded(L, Op::sign, argument(L, 1));
  if (!traced) lua_pushnumber(L, argument(L, -1).constant());
  return 1;
}

// Lua's own select() is kept: it is meant where the first argument is a plain number or "#".
int select_function(lua_State* L) {
  if (is_traced(L, 1))
    return push_recorded(L, Op::select, argument(L, 1), argument(L, 2), argument(L, 3));
  if (lua_isboolean(L, 1)) return lua_pushvalue(L, lua_toboolean(L, 1) ? 2 : 3), 1;
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
  return lua_gettop(L);
}

// Takes over a function of `math`, there and as a global.
void wrap(lua_State* L, const char* name, const char* global, lua_CFunction with) {
  lua_getglobal(L, "math");
  lua_getfield(L, -1, name);
  lua_pushcclosure(L, with, 1);
  lua_pushvalue(L, -1);
  lua_setfield(L, -3, name);
  lua_setglobal(L, global);
  lua_pop(L, 1);
}

}  // namespace

void begin_trace(lua_State* L) {
  lua_rawgetp(L, LUA_REGISTRYINDEX, &trace_key);
  lua_pushinteger(L, lua_tointeger(L, -1) + 1);
  lua_rawsetp(L, LUA_REGISTRYINDEX, &trace_key);
  lua_pushnil(L);
  lua_rawsetp(L, LUA_REGISTRYINDEX, &nodes_key);
  lua_pop(L, 1);
}

lua_Integer trace_number(lua_State* L) {
  lua_rawgetp(L, LUA_REGISTRYINDEX, &trace_key);
  const lua_Integer number = lua_tointeger(L, -1);
  lua_pop(L, 1);
  return number;
}

void push_traced(lua_State* L, const Expr& value) {
  LuaSandbox::of(L).charge(L, 5);
  if (!value.is_constant()) check_size(L, *value.tape());
  const lua_Integer call = trace_number(L);
  new (lua_newuserdatauv(L, sizeof(Traced), 0)) Traced{value, call};
  luaL_setmetatable(L, kind);
}

bool to_expr(lua_State* L, int index, Expr& value) {
  if (lua_type(L, index) == LUA_TNUMBER) {
    value = lua_tonumber(L, index);
    return true;
  }
  const auto* traced = static_cast<const Traced*>(luaL_testudata(L, index, kind));
  if (!traced) return false;
  if (!traced->value.is_constant() && traced->call != trace_number(L))
    refuse(L, "a traced number is used after the call that made it",
           "no numbers kept between calls");
  value = traced->value;
  return true;
}

void install_traced(lua_State* L) {
  static constexpr luaL_Reg operators[] = {
      {"__add", binary<Op::add>}, {"__sub", binary<Op::sub>}, {"__mul", binary<Op::mul>},
      {"__div", binary<Op::div>}, {"__unm", negate},          {"__pow", power},
      {"__mod", modulo},          {"__idiv", floor_division}, {"__lt", comparison},
      {"__le", comparison},       {"__eq", comparison},       {"__tostring", to_text},
      {nullptr, nullptr}};
  luaL_newmetatable(L, kind);
  luaL_setfuncs(L, operators, 0);
  lua_pop(L, 1);

  wrap(L, "sin", "sin", function<Op::sin>);
  wrap(L, "cos", "cos", function<Op::cos>);
  wrap(L, "tan", "tan", function<Op::tan>);
  wrap(L, "asin", "asin", function<Op::asin>);
  wrap(L, "acos", "acos", function<Op::acos>);
  wrap(L, "atan", "atan2", function<Op::atan2>);
  wrap(L, "sqrt", "sqrt", function<Op::sqrt>);
  wrap(L, "exp", "exp", function<Op::exp>);
  wrap(L, "log", "log", function<Op::log>);
  wrap(L, "abs", "abs", function<Op::abs>);
  wrap(L, "floor", "floor", function<Op::floor>);
  lua_register(L, "sign", sign_function);
  lua_register(L, "less", binary<Op::less>);
  lua_getglobal(L, "select");
  lua_pushcclosure(L, &select_function, 1);
  lua_setglobal(L, "select");
  lua_pushnumber(L, 3.141592653589793);
  lua_setglobal(L, "pi");
  lua_pushnumber(L, 3.141592653589793 / 180);
  lua_setglobal(L, "deg");
  install_rigid(L);
}

}  // namespace talus::lua
