// Recordings laid out for a plan: batches of `lanes` poses side by side, with everything that
// depends on data alone already computed. Rows of one group (of unknowns shared by a group of rows)
// share their batches, so a batch has one instance of every group unknown.
#pragma once

#include <vector>

#include "framework/kinematics/plan.h"
#include "framework/recordings/recordings.h"

namespace talus {

// Which instance of each group unknown a recorded row belongs to. Unknowns per pose have none.
struct Groups {
  struct Unknowns {
    int unknown;                // index in Program::unknowns
    std::vector<int> instance;  // of each recorded row
    int instances = 0;
    std::vector<std::string> labels;  // "location=2, hole=1"
  };
  std::vector<Unknowns> shared;
  std::vector<int> latent;  // indices of the unknowns per pose

  Groups(const Program& program, const Recordings& recordings);
  int total() const;
};

class Dataset {
 public:
  struct Batch {
    std::vector<int>
        poses;      // recorded rows in the lanes; padded lanes repeat the first and are masked
    int count = 0;  // lanes in use
    std::vector<int> instance;  // per shared unknown
  };
  Dataset(const Program& program, const Plan& plan, const Recordings& recordings,
          const std::vector<std::size_t>& rows, const Groups& groups);

  int batches() const { return static_cast<int>(batches_.size()); }
  const Batch& batch(int b) const { return batches_[b]; }
  const double* data(int b) const { return &data_[static_cast<std::size_t>(b) * block_]; }
  const double* mask(int b) const {
    return &mask_[static_cast<std::size_t>(b) * mask_block_];
  }  // [row][lane]: 1 or 0
  std::size_t poses() const { return poses_; }
  std::size_t used() const { return used_; }        // residual rows that count
  std::size_t missing() const { return missing_; }  // residual rows left out for want of a value
  bool complete() const { return missing_ == 0; }

 private:
  std::vector<Batch> batches_;
  Buffer data_, mask_;
  std::size_t block_ = 0, mask_block_ = 0, poses_ = 0, used_ = 0, missing_ = 0;
};

}  // namespace talus
