// The verdict of a diagnosis and its sentence, from all that was found and judged.
#pragma once

#include "framework/diagnosis/diagnosis.h"

namespace talus {

void conclude(Diagnosis& diagnosis);

}  // namespace talus
