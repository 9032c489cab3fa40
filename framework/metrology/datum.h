// Frames made of fitted shapes, and what is seen from one frame of another, each with its
// derivative by the raw coordinates of a pose.
#pragma once

#include <vector>

#include "framework/metrology/shape_fit.h"

namespace talus {

// A frame in the machine's axes. `turn` is the small rotation (rad, machine's axes) by each raw
// coordinate: dR = [turn] R.
struct DerivedFrame {
  Derived origin;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Matrix3Xd turn;  // 3 x n
};

// `square` becomes the largest departure (rad) from a right angle of the shapes' axes. InputError
// where the shapes fix no origin, or two axes along (nearly) one line.
DerivedFrame frame_of(const Datum& datum, const std::vector<FittedShape>& shapes, double& square);

// Columns of a feature of some kind, as its plugin observes them, and their derivatives.
struct DerivedColumns {
  std::vector<double> values;
  Eigen::MatrixXd by;
};
DerivedColumns columns_of(const Feature& feature, const DerivedFrame& frame);
DerivedColumns columns_of(const Feature& feature, const FittedShape& shape, const DerivedFrame* in);
DerivedFrame seen_from(const DerivedFrame& in, const DerivedFrame& frame);

}  // namespace talus
