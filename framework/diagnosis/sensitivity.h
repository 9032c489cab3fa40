// What would have been seen, had it been there? Of every suspect the smallest magnitude that these
// poses would show in 80 of 100 recordings, and the suspect it would most likely be taken for. This
// depends on the poses and the noise, not on what was measured.
//
// Magnitudes are multiples of the typical one: 0.3 with typical amounts sine = cosine = 0.05 deg is
// an amplitude of 0.015 deg. Over the directions that the amounts may take (a phase) and over the
// suspect's forms and change points the median is given, and the range.
#pragma once

#include <vector>

#include "framework/diagnosis/screen.h"

namespace talus {

struct Sensitivity {
  int suspect = -1;
  Pick pick;                    // the form (and change point) of the median
  double smallest_visible = 0;  // in typical magnitudes; infinite where nothing is seen
  double best = 0, worst = 0;   // most and least favourable direction, form and change point
  double visible = 0;           // |X~| / |X| of the median form
  int nearest = -1;             // the other suspect that imitates it best; -1: none does at all
  Pick nearest_pick;
  double imitates = 0;  // share of the signal that the nearest one takes over
};

struct SensitivityOptions {
  double log_threshold = -8.1;  // of p, where the gate opens: Gate::threshold
  double power = 0.8;
  int threads = 1;
};

// One entry per suspect, in their order.
std::vector<Sensitivity> sensitivity(const Screen& screen, const SensitivityOptions& options = {});

}  // namespace talus
