// Numbers and transforms in Lua that record what is done with them. A plugin's Lua function is
// called with traced numbers (see expr.h) where a plain function would get floats; what it returns
// is the expression it computes.
//
//     + - * / // % ^ (constant exponent), unary -, sin cos tan asin acos atan2 sqrt exp log abs
//     sign floor, less(a, b), select(condition, a, b); math.sin and the like take them too
//     rotate_x/y/z(angle), translate_x/y/z(by), translate(x, y, z), rotate_about(x, y, z, angle),
//     rotate_by_vector(x, y, z), inverse(T), rotation_vector(T), T1 * T2,
//     T:rotation(i, j), T:translation(i), T:point(x, y, z)
//
// They live as long as the call: one kept in a variable outside it is refused in the next call.
#pragma once

#include <lua.hpp>

#include "framework/kinematics/rigid.h"

namespace talus::lua {

// Adds the functions to the globals; runs protected.
void install_traced(lua_State* L);

// Begins a call: what was traced before is no longer accepted.
void begin_trace(lua_State* L);

// All of these may raise a Lua error.
void push_traced(lua_State* L, const Expr& value);
Rigid<Expr>* push_rigid(lua_State* L);  // an identity, to be filled in guard()

// Nothing (false, null) where the value at `index` is something else.
bool to_expr(lua_State* L, int index, Expr& value);  // traced or a plain number
const Rigid<Expr>* to_rigid(lua_State* L, int index);

}  // namespace talus::lua
