// A serial chain of hinges, whatever their joint types, written anew as Denavit-Hartenberg joints
// (dh_chain.h): a mount, one <dh> per hinge, and placements of the frames that the rest of the
// model refers to. Every transform between those frames is the same as before at every posture.
//
// Sensors, unknowns, features and all else stay as they are; a joint's coordinate stays the text it
// was, with an angle added. The geometry is that of the nominal values, and fixed. Masses go to the
// joint that carries them. DH joints keep the names of the joints they stand for, with _dh added
// where the rest of the model means the frame of that name.
#pragma once

#include "framework/model/model.h"
#include "framework/registry/registry.h"

namespace talus {

// InputError where the chain branches, where a joint does anything but turn about one axis by its
// coordinate, or where axes are so nearly parallel that the parameters would not be accurate.
Model dh_model(const Model& model, const Registry& registry);

}  // namespace talus
