// Plugins written in Lua: joints, sensors, residuals and effects, in files of their own or above a
// model.
//
//     joint "dh2" {
//       theta = coordinate(angle, "rotation about z of A"),
//       d = length(0, "offset along z of A"),       -- default, meaning (may be left out)
//       a = length("0 mm"), alpha = angle("90 deg"),
//       transform = function(p) return rotate_z(p.theta) * translate_z(p.d) * ... end }
//     sensor "pot" { reading = angle, gives = angle, slope = number(1),
//       value = function(reading, p) return p.slope * reading end }
//     residual "axis_offset" { of = { "frame" }, rows = { "x", length, "y", length },
//       value = function(model, measured, p)
//         return { measured.frame:translation(1) - model:translation(1), ... } end }
//     effect "detent" { acts = "reading", on = angle,
//       height = amount(angle, "0.02 deg", "usual size and meaning"),
//       teeth = setting(number, 8, { 6, 12 }, "default, values to try, meaning"),
//       value = function(around, p) return p.height * sin(p.teeth * around.reading) end }
//
// `length()` without a default must be given; `choice({"one", "two"}, meaning)` is a word, the
// first the default; `unit("deg/(N*m)")` makes a dimension like length and angle. As everywhere
// inside, numbers are mm, rad, s, kg; text carries its unit. Inputs are in the order in which they
// are made. `measured` has kind, frame (a transform: frames and points), vector (x, y, z:
// directions), angles, scalar. An effect (registry/effect.h) may say needs = { "load", "time" },
// driver = "other" ("own", "any"), forms = { { "a", "b" }, { "c" } }, everywhere, at_joint,
// reference; `around` has what it asks for (around.force[1] to [3]), and by `acts` it returns a
// number, { x =, y =, z =, rx =, ry =, rz = } (what is left out is 0) or three rows of three. The
// functions get traced numbers (lua_traced.h).
#pragma once

#include <lua.hpp>

#include "framework/model/units.h"
#include "framework/registry/plugin.h"

namespace talus {
class LuaSandbox;
}

namespace talus::lua {

// Adds joint, sensor, residual, effect, coordinate, choice, amount, setting, unit and the
// dimensions. Runs protected.
void install_definitions(lua_State* L);

void install_inputs(lua_State* L);  // its part: all but the families

// An input as Lua carries it, as user data; its meaning (and a choice's words) are beside it.
struct InputSpec {
  bool choice = false, coordinate = false, required = false;
  Dimension dimension;
  double otherwise = 0;
  lua_Integer order = 0;
  Role role = Role::plain;
  double typical = 0;
};

// The dimension that the function at `index` (length, angle, unit(...)) stands for; does not raise.
const Dimension* dimension_at(lua_State* L, int index);
// The input at `index`; its meaning and words (a setting's values to try) are user values 1 and 2.
// Null where it is none.
const InputSpec* input_at(lua_State* L, int index);

// Gives the plugin the functions that call those of its definition, the table kept under the number
// `definition` in Lua's registry.
void bind_lua(Plugin& plugin, LuaSandbox& sandbox, int definition);

}  // namespace talus::lua
