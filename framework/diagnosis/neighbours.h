// How the poses next to a pose fit: next to it in the order of recording, in each recorded column,
// in each coordinate. What a pose shares with its neighbours is no blunder of its own.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "framework/recordings/recordings.h"

namespace talus {

// A number by which poses can be put in order.
struct PoseOrder {
  std::string name;
  std::vector<double> values;  // NaN: not known of this pose
};

// The rows' order (`pose`, where it is recorded) and every column that differs between these rows,
// but for those named: a blunder in a measured column has its neighbours there among the blunders.
std::vector<PoseOrder> pose_orders(const Recordings& recordings,
                                   const std::vector<std::size_t>& rows,
                                   const std::vector<std::string>& without);

class Neighbours {
 public:
  explicit Neighbours(const std::vector<PoseOrder>& orders);
  // The largest of the levels of this pose's neighbourhoods that are elevated, zero where none is.
  // The level of a neighbourhood is the median of `misfit` over the poses next to it; it is
  // elevated where it exceeds `elevated` times the median of all.
  double level(std::span<const double> misfit, int pose, double elevated) const;

 private:
  struct Line {
    std::vector<int> sorted;                     // numbers of poses
    std::vector<std::array<std::size_t, 3>> at;  // of each pose: its place, and from where to where
                                                 // its value stands; all zero where it has none
  };
  std::vector<Line> lines_;
};

double median(std::vector<double> values);  // NaN of none

}  // namespace talus
