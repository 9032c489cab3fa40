#include "framework/dsl/lua_rigid.h"

#include <new>

#include "framework/dsl/lua_sandbox.h"
#include "framework/dsl/lua_traced.h"

namespace talus::lua {
namespace {

constexpr const char* kind = "transform";
constexpr std::size_t most_motions = 1000;
constexpr std::int64_t steps_per_motion = 500;

struct Placed {
  Rigid<Expr> value;
  lua_Integer call;
};

Expr number(lua_State* L, int index) {
  Expr value;
  if (!to_expr(L, index, value)) luaL_typeerror(L, index, "number");
  return value;
}

const Rigid<Expr>& transform(lua_State* L, int index) {
  const Rigid<Expr>* t = to_rigid(L, index);
  if (!t) luaL_typeerror(L, index, kind);
  return *t;
}

template <Rigid<Expr> (*make)(const Expr&)>
int elementary(lua_State* L) {
  const Expr amount = number(L, 1);
  Rigid<Expr>* result = push_rigid(L);
  guard(L, [&] { *result = make(amount); });
  return 1;
}

template <Rigid<Expr> (*make)(const Expr&, const Expr&, const Expr&)>
int of_three(lua_State* L) {
  const Expr x = number(L, 1), y = number(L, 2), z = number(L, 3);
  Rigid<Expr>* result = push_rigid(L);
  guard(L, [&] { *result = make(x, y, z); });
  return 1;
}

int about(lua_State* L) {
  const Expr x = number(L, 1), y = number(L, 2), z = number(L, 3), angle = number(L, 4);
  Rigid<Expr>* result = push_rigid(L);
  guard(L, [&] { *result = rotate_about(x, y, z, angle); });
  return 1;
}

int product(lua_State* L) {
  const Rigid<Expr>&a = transform(L, 1), &b = transform(L, 2);
  const std::size_t motions = a.motions().size() + b.motions().size();
  if (motions > most_motions) refuse(L, "a product of more than 1000 motions");
  LuaSandbox::of(L).charge(L, static_cast<std::int64_t>(motions));
  Rigid<Expr>* result = push_rigid(L);
  guard(L, [&] { *result = a * b; });
  return 1;
}

int inverted(lua_State* L) {
  const Rigid<Expr>& t = transform(L, 1);
  LuaSandbox::of(L).charge(L, static_cast<std::int64_t>(t.motions().size()));
  Rigid<Expr>* result = push_rigid(L);
  guard(L, [&] { *result = inverse(t); });
  return 1;
}

// Pushes as traced numbers what `compute` writes; it looks at the entries of t.
template <int count, class Compute>
int entries(lua_State* L, const Rigid<Expr>& t, Compute compute) {
  LuaSandbox::of(L).charge(L, steps_per_motion * static_cast<std::int64_t>(1 + t.motions().size()));
  Expr result[count];
  guard(L, [&] { compute(result); });
  for (const Expr& e : result) push_traced(L, e);
  return count;
}

int axis(lua_State* L, int index) {
  const lua_Integer i = luaL_checkinteger(L, index);
  luaL_argcheck(L, i >= 1 && i <= 3, index, "expected 1, 2 or 3");
  return static_cast<int>(i) - 1;
}

int rotation_entry(lua_State* L) {
  const Rigid<Expr>& t = transform(L, 1);
  const int row = axis(L, 2), column = axis(L, 3);
  return entries<1>(L, t, [&](Expr* out) { *out = t.rotation(row, column); });
}

int translation_entry(lua_State* L) {
  const Rigid<Expr>& t = transform(L, 1);
  const int row = axis(L, 2);
  return entries<1>(L, t, [&](Expr* out) { *out = t.translation(row); });
}

int point(lua_State* L) {
  const Rigid<Expr>& t = transform(L, 1);
  const Expr x = number(L, 2), y = number(L, 3), z = number(L, 4);
  return entries<3>(L, t, [&](Expr* out) {
    const Vector3<Expr> p = t * Vector3<Expr>{x, y, z};
    for (int i = 0; i < 3; ++i) out[i] = p[i];
  });
}

int vector_of_rotation(lua_State* L) {
  const Rigid<Expr>& t = transform(L, 1);
  return entries<3>(L, t, [&](Expr* out) {
    const Vector3<Expr> v = rotation_vector(t.rotation());
    for (int i = 0; i < 3; ++i) out[i] = v[i];
  });
}

int destroy(lua_State* L) {
  static_cast<Placed*>(lua_touserdata(L, 1))->~Placed();
  return 0;
}

int to_text(lua_State* L) { return lua_pushstring(L, kind), 1; }

}  // namespace

Rigid<Expr>* push_rigid(lua_State* L) {
  LuaSandbox::of(L).charge(L, steps_per_motion);
  const lua_Integer call = trace_number(L);
  auto* placed = new (lua_newuserdatauv(L, sizeof(Placed), 0)) Placed{{}, call};
  luaL_setmetatable(L, kind);
  return &placed->value;
}

const Rigid<Expr>* to_rigid(lua_State* L, int index) {
  const auto* placed = static_cast<const Placed*>(luaL_testudata(L, index, kind));
  if (!placed) return nullptr;
  if (placed->call != 0 && placed->call != trace_number(L))
    refuse(L, "a transform is used after the call that made it",
           "no transforms kept between calls");
  return &placed->value;
}

void install_rigid(lua_State* L) {
  static constexpr luaL_Reg functions[] = {{"rotate_x", elementary<rotate_x<Expr>>},
                                           {"rotate_y", elementary<rotate_y<Expr>>},
                                           {"rotate_z", elementary<rotate_z<Expr>>},
                                           {"translate_x", elementary<translate_x<Expr>>},
                                           {"translate_y", elementary<translate_y<Expr>>},
                                           {"translate_z", elementary<translate_z<Expr>>},
                                           {"translate", of_three<translate<Expr>>},
                                           {"rotate_by_vector", of_three<rotate_by_vector<Expr>>},
                                           {"rotate_about", about},
                                           {"inverse", inverted},
                                           {"rotation_vector", vector_of_rotation}};
  static constexpr luaL_Reg methods[] = {{"rotation", rotation_entry},
                                         {"translation", translation_entry},
                                         {"point", point},
                                         {nullptr, nullptr}};
  for (const luaL_Reg& f : functions) lua_register(L, f.name, f.func);
  luaL_newmetatable(L, kind);
  lua_createtable(L, 0, 3);
  luaL_setfuncs(L, methods, 0);
  lua_setfield(L, -2, "__index");
  lua_pushcfunction(L, product);
  lua_setfield(L, -2, "__mul");
  lua_pushcfunction(L, to_text);
  lua_setfield(L, -2, "__tostring");
  lua_pushcfunction(L, destroy);
  lua_setfield(L, -2, "__gc");
  lua_pop(L, 1);
}

}  // namespace talus::lua
