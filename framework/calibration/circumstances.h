// The circumstances that a model's effects depend on, as columns of the recordings: those that are
// recorded (pose, time, session, temperature, approach_<joint>, and payloads and the direction of
// gravity, which loads follow from), and those that follow from these and the readings
// (kinematics/covariates.h, load_columns.h).
#pragma once

#include <span>

#include "framework/calibration/settings.h"
#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

// The recordings and all that follows from them and that the program needs; loads at the given
// parameters, or at the nominal ones. InputError where something that must be recorded or known is
// not.
Recordings with_derived(const Program& program, const Recordings& recordings,
                        std::span<const double> parameters = {});

// Does the program depend on loads, which change a little with its parameters?
bool depends_on_loads(const Program& program);

// The settings with values for all covariates: from the table's columns; where it has none, poses
// are counted from 1 and 30 s apart, in session 1, at 20 degC, each joint approached in the sense
// of its last move, payloads as the model says or zero; rows of one group where an unknown is
// shared by groups, each row its own group where groups are held out. Those that a recording would
// contain, and those that the table has, are in Settings::circumstances as well. Settings that have
// these are returned as they are.
Settings with_circumstances(const Program& program, Settings settings,
                            const Recordings* table = nullptr);

}  // namespace talus
