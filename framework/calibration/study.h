// How well would this linkage find these axes? A linkage is carried through a motion whose axes are
// known; its readings get the encoders' noise; from the noisy readings its own model gives poses,
// from these the axes are located, and their errors are told, design by design and noise by noise
// (as in the computational analysis that Bonny, Hull and Howell 2013 built their linkage on).
//
// Only the encoders' noise is there: the linkage's parameters are known exactly. Trial t of a
// design draws the same deviates for every noise, so noises are compared with the luck taken out.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/calibration/axes.h"
#include "framework/calibration/inverse.h"
#include "framework/calibration/linkage_poses.h"
#include "framework/calibration/simulate.h"

namespace talus {

// The motion that is applied: hinges whose nominal places are the truth, and the poses.
class StudiedMotion {
 public:
  struct Choices {
    std::string of, by;
    bool anatomical = false;
    std::vector<std::string> reverse;
  };
  // InputError where the poses do not let the axes be found, even without noise.
  StudiedMotion(const Program& program, const Settings& settings, const Choices& choices);

  const Program& program() const { return *program_; }
  const Recordings& poses() const { return poses_; }
  const AxisFinder& finder() const { return finder_; }
  const std::vector<View>& views() const { return views_; }

  // Errors (mm, rad) of the four numbers of each axis where the frame is measured at `measured`;
  // NaN where no fit is found. Of any thread, each with a finder of its own.
  std::vector<double> errors(AxisFinder& finder,
                             const std::vector<Eigen::Isometry3d>& measured) const;

 private:
  std::vector<double> numbers(AxisFinder& finder, std::span<const double> parameters) const;

  const Program* program_;
  AxisFinder finder_;
  Recordings poses_;
  std::vector<View> views_;
  std::vector<std::size_t> rows_;
  Plan plan_;
  std::vector<double> truth_, start_;
  Eigen::MatrixXd latent_;
};

struct StudyRow {
  std::size_t outside = 0, unreachable = 0;  // poses: beyond a sensor's range; not to be reached
  std::size_t trials = 0;                    // that gave axes; 0 where a pose is unreachable
  std::vector<double> rmse, error;           // per number; standard error of the rmse
};

struct StudyOptions {
  int trials = 200, threads = 1;
  std::uint64_t seed = 1;
  std::function<void(double)> progress;
};

// A design, ready to be tried: the readings that the motion takes it through.
class StudiedDesign {
 public:
  StudiedDesign(Program& linkage, const StudiedMotion& motion, int threads);
  // `noise`: standard deviation of every angle that is read (rad). `design`: numbers the seeds.
  StudyRow run(double noise, std::uint64_t design, const StudyOptions& options) const;

 private:
  const Program* linkage_;
  const StudiedMotion* motion_;
  Recovered reached_;
  LinkagePoses poses_;
};

}  // namespace talus
