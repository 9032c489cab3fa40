// Blunders beside a hypothesis.
#pragma once

#include "framework/diagnosis/hypothesis.h"
#include "framework/diagnosis/outliers.h"

namespace talus {

// What is far outside with the effects in the model. Poses next to the one from which an effect
// acts may stand on its wrong side rather than be wrong: where fewer are wrong if it sets in before
// or after them, that is believed.
Outliers blunders_beside(const Ground& ground, const Trial& trial, const Split& whole,
                         const OutlierOptions& options);

}  // namespace talus
