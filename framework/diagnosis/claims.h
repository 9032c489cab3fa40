// What a search found, as claims: findings that anybody would notice, and hints, which are too
// small to be claimed or only what the formula of a finding leaves over. What follows noise that is
// not independent from pose to pose is no claim but a fault of the recordings.
#pragma once

#include "framework/diagnosis/faults.h"
#include "framework/diagnosis/noise.h"
#include "framework/diagnosis/search.h"
#include "framework/diagnosis/shown.h"

namespace talus {

struct NamedRival {
  std::string effect, location;
  double probability = 0;
};

struct Finding {
  std::string effect, location;
  double probability = 0;
  std::vector<ShownValue> parameters;
  std::string driver;     // the coordinate that drives it, where one does
  double delta_chi2 = 0;  // lost on the rows to fit without it, all else refitted
  double delta_bic = 0;
  double p_value = 1;                            // of the best of all candidates by chance
  double sigmas = 0;                             // what it explains per pose, in sigmas of a pose
  double heldout_before = 0, heldout_after = 0;  // without and with it, the others kept
  std::vector<NamedRival> rivals;
  std::string statement;
  Accepted accepted;
};

struct Claims {
  std::vector<Finding> findings, hints;
  std::vector<Fault> faults;
};

// Two effects of one joint: of its sensor, axis or link; and of one kind, in what they move and
// what they depend on, so that together they may be the shape of something third.
bool one_place(const Accepted& a, const Accepted& b);
bool one_kind(const Accepted& a, const Accepted& b);

// Takes out of the search what noise correlated from pose to pose makes by itself; a fault then.
std::vector<Fault> without_correlated(const Ground& ground, const NoiseVerdict& noise,
                                      Search& search, const SearchOptions& options);

Claims claims_of(const Search& search, std::size_t poses, std::size_t rows,
                 const UnitSystem& units);

}  // namespace talus
