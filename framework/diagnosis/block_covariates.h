// What some effects depend on, as numbers of the recorded rows by which regions can be held out
// (blocks.h): readings and unknowns of the pose at the joints they act on or are driven by, the
// time, the temperature, payloads.
#pragma once

#include "framework/diagnosis/blocks.h"
#include "framework/diagnosis/hypothesis.h"

namespace talus {

// `fields`: the model with a field at every place. `fit` of `program`: where the unknowns of the
// poses were found. Circumstances that were not recorded, or are the same everywhere, are left out.
std::vector<BlockCovariate> block_covariates(const std::vector<Accepted>& effects,
                                             const Program& fields, const Recordings& recordings,
                                             const Program& program, const Fit& fit);

}  // namespace talus
