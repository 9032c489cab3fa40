// The five things that no analysis of recordings like these can see, in words and figures of this
// model and these recordings (see seen.h). They are said whatever was found.
#pragma once

#include "framework/diagnosis/seen.h"

namespace talus {

std::vector<BlindSpot> blind_spots(const Seen& seen, const Program& program, const Linearised& null,
                                   const Recordings& recordings, double log_threshold,
                                   double noise);

// "encoder_eccentricity" as people write it.
std::string spoken(std::string id);

}  // namespace talus
