// Functional axes: where the hinges of a measured motion lie (the flexion-extension and the
// longitudinal-rotation axis of a knee, say), all located at once by least squares.
//
// The model is a chain of hinges between two measured bodies, their angles unknown in each pose or
// read. An axis is described in the body in which it stands still: the first in the body the chain
// starts from, the last in the body it ends with, one in between in the first body at zero angles.
// There it is a line, given in a view, a frame of that body, by four numbers (Bonny, Hull and
// Howell 2013, sec. 2.3): two positions, where it pierces the view's plane at right angles to the
// axis's main direction, and two orientations, the angles by which its projections on the two
// planes through the main direction lean towards the other two axes. A lean is positive towards
// the positive axis; it is named after the axis of the view that the turn is about.
//
//     AxisFinder finder(program);
//     Located at = finder.locate(recordings, rows, {});
//     const std::vector<View> views = finder.anatomical_views(at, "flexion", {});
//     finder.describe(at, views);
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "framework/calibration/covariance.h"
#include "framework/calibration/fit.h"
#include "framework/kinematics/posture.h"

namespace talus {

struct Line {
  Eigen::Vector3d point, direction;  // mm, unit vector
};

// A frame of the body in which an axis stands still, and the one of its axes (0, 1, 2) that the
// line's direction is nearest to.
struct View {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();  // T_body_view
  int main = 0;
  std::string name;  // "B", "F_a"
};

// Two positions, two leans (mm, rad), each towards the other two axes of the view in their order.
std::array<double, 4> coordinates_of(const Line& line, const View& view);

// What directions along, and turns about, the three axes of a view are called.
struct AxisLabels {
  std::array<std::string, 3> along{"x", "y", "z"}, about{"about x", "about y", "about z"};
  std::array<std::string, 4> of(int main) const;  // of the four numbers
};

struct Hinge {
  std::string name;            // of the joint
  std::string coordinate;      // of the unknown or sensor that moves it
  int axis = -1, number = -1;  // in Posture::axes(); among readings, then unknowns
  int body = -1;               // frame in which it is described
  bool still = true;           // it stands still there; otherwise: as it lies at zero angles
  double sense = 1;            // -1: the line points against the growing coordinate
};

struct LocatedAxis {
  Line line;                             // in its body
  std::array<double, 4> value{}, std{};  // in its view
  double low = 0, high = 0, noise = 0;   // of the coordinate over the motion; its own std
  bool determined = true;
  std::string why;  // where it is not determined
};

// Two axes that follow each other.
struct Apartness {
  int first, second;
  double angle = 0, angle_std = 0, distance = 0, distance_std = 0;
};

struct Located {
  Fit fit;
  Covariance covariance;
  bool observed = false;  // which covariance the standard uncertainties are from
  std::vector<LocatedAxis> axes;
  std::vector<Apartness> apart;
  Eigen::MatrixXd coordinates;  // of the hinges, poses x hinges
};

struct LocateOptions {
  FitOptions fit;
  // Uncertainties from the residuals as they are, even where the stated noise explains them.
  bool observed = false;
};

class AxisFinder {
 public:
  // `feature`: the measured frame whose two bodies the hinges join; the only one where empty.
  // `reverse`: hinges whose line is to point the other way. InputError where the model has no
  // such frame, no hinge, or unknowns shared by groups of rows.
  explicit AxisFinder(const Program& program, const std::string& feature = {},
                      const std::vector<std::string>& reverse = {});

  const std::vector<Hinge>& hinges() const { return hinges_; }
  const Program& program() const { return *program_; }
  const Feature& feature() const { return *feature_; }
  std::string body(const Hinge& hinge) const {
    const Chain& chain = program_->chains[feature_->chain];
    return hinge.body == end_ ? chain.at : chain.in;
  }
  // By the name of a joint or of its coordinate.
  int hinge(const std::string& name, const Place& place) const;

  // Each hinge's line in its body.
  std::vector<Line> lines(std::span<const double> parameters);

  Located locate(const Recordings& recordings, const std::vector<std::size_t>& rows,
                 const LocateOptions& options);

  // The bodies' own frames.
  std::vector<View> body_views(const Located& reference) const;
  // Frames made from two axes as they lie at zero flexion (Bonny 2013, Fig. 6): F_a has its origin
  // on the flexion axis at the foot of the shortest line to the other, j along the flexion axis, i
  // along the shortest line, k = i x j as nearly along the other axis as that allows; T_a lies
  // 20 mm below along k. `zero`: readings, then unknowns, at zero flexion.
  std::vector<View> anatomical_views(const Located& reference, const std::string& flexion,
                                     const std::vector<double>& zero, const Place& place);
  // Fills in the four numbers of each axis in its view and their standard uncertainties; an axis
  // that the motion does not determine is marked.
  void describe(Located& located, const std::vector<View>& views);

  // Readings, then unknowns, of a located pose: the `k`-th of `rows`.
  std::vector<double> pose(const Recordings& recordings, const std::vector<std::size_t>& rows,
                           const Located& located, std::size_t k) const;

 private:
  std::pair<std::vector<double>, Eigen::MatrixXd> numbers(const std::vector<double>& x,
                                                          const std::vector<View>& views);

  const Program* program_;
  const Feature* feature_;
  Posture posture_;
  std::vector<Hinge> hinges_;
  int in_ = -1, end_ = -1;
};

}  // namespace talus
