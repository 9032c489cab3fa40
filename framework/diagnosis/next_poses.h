// Which poses to record next, to see what is suspected and to tell it from what it may be taken
// for.
//
// With G the projected products X~^T X~ of the design so far, a further pose with columns J_k, X_k
// adds
//     G += E^T (I + J_k H^-1 J_k^T)^-1 E,   E = X_k - J_k C,
// H = J^T J with priors, C = H^-1 J^T X what the geometry absorbs: six rows per pose, so a whole
// pool is tried for the price of a few products. A suspect of typical magnitude is seen once its
// chi-square reaches 22, and told from a rival once what that one cannot imitate reaches 12. Poses
// are taken one by one, each the best for the worst off, and exchanged while that helps.
#pragma once

#include <vector>

#include "framework/diagnosis/screen.h"

namespace talus {

// Rows of one pose of the pool, whitened as the recorded ones; columns as in the baseline and in
// the candidates.
struct PoolPose {
  Eigen::MatrixXd columns, candidates;
};

// What is to be seen (with which amounts; empty: any direction of typical size), and the forms it
// is to be told from.
struct Target {
  int form = -1;
  Eigen::VectorXd amounts;
  std::vector<int> rivals;
};

struct NextPosesOptions {
  int count = 8;
  double seen = 22, told = 12;  // chi-square needed
  double reach = 10;            // of rivals, in typical amounts
  int threads = 1;
};

struct TargetGain {
  double seen_before = 0, seen_after = 0;  // chi-square of the signal
  double told_before = 0, told_after = 0;  // of what the nearest rival leaves; as above without one
  bool attainable = true;  // false where even the whole pool would not do: left out of the choice
};

struct NextPoses {
  std::vector<int> chosen;          // of the pool, best first
  double before = 0, after = 0;     // least of chi-square / needed over the attainable targets
  std::vector<TargetGain> targets;  // as asked for
  std::vector<std::vector<double>> loss;  // [chosen][target]: share of its chi-square that would be
                                          // lost without the pose; 0 where it is not attainable
};

// The design so far is the baseline's columns (its priors' rows included) and the candidates'.
NextPoses next_poses(const Baseline& baseline, const Candidates& candidates,
                     const std::vector<PoolPose>& pool, const std::vector<Target>& targets,
                     const NextPosesOptions& options = {});

}  // namespace talus
