// A linkage as bodies of the engine. Joint i is three bodies, one in the other:
//
//     stator<i>   at the end of the link before; bearings that give way move it
//     motor<i>    turns about its z: a free hinge where the linkage is held, otherwise placed by
//     hand rotor<i>    behind whatever is elastic or loose between motor and link
//
// then the link: one piece, or many with springs between them, up to the body link<i>. The
// measured body is `end`; `payload` is a mass there. Sites disc<i> and head<i> are the centre of
// an encoder's scale, on the motor, and its read head, in the encoder's own housing on the stator.
// SI units.
#pragma once

#include <string>

#include "tests/engine/linkage.h"

namespace engine {

constexpr double head_radius = 0.02;  // m
constexpr int pieces = 30;            // of a link that bends

std::string mjcf(const Linkage& linkage);

}  // namespace engine
