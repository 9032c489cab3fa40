// The floor: residual and exact Jacobian of the same linkage as fast as this machine allows.
//
// Everything is written for this one chain. Poses lie as a structure of arrays, one pose per SIMD
// lane. Joint axes are carried backwards from E to B as seen in the model's frame E, which is where
// the residuals live; what does not depend on the pose (the end frame) is done once. A unit turn
// about axis u through point o moves the error position e and the error rotation E by
//
//     de = (e - o) x u,        dE = -[u]x E,
//
// and a unit shift along u by de = -u, dE = 0. So a column of a turn costs one cross product and,
// for the three projection angles, one product with the 3x3 matrix M of their derivatives:
//
//          [ -1              E12 E22 / nx    E12 E32 / nx ]       nx = E22^2 + E32^2
//     M =  [ E23 E13 / ny    -1              E23 E33 / ny ]       ny = E13^2 + E33^2
//          [ E31 E11 / nz    E31 E21 / nz    -1           ]       nz = E11^2 + E21^2
#pragma once

#include <memory>

#include "tests/bench/isl_data.h"

namespace talus::bench {

class IslSimd {
 public:
  static const int lanes;  // poses per batch
  static constexpr int columns = isl_parameters + 1;

  IslSimd(const IslPoses& poses, const IslFactors& factors);
  ~IslSimd();
  int batches() const { return batches_; }

  // Takes parameters and does what they alone determine.
  void set(const IslParameters& parameters);

  // Evaluates `count` batches from `first` on into [batch][row][column][lane], aligned to 64 bytes:
  // columns 0 to 37 are the Jacobian, column 38 is the residual. Lanes beyond the last pose are
  // empty: zero in every row.
  void evaluate(int first, int count, double* rows) const;

  struct Fixed;

 private:
  struct Free {
    void operator()(double* p) const;
  };
  IslFactors factors_;
  std::unique_ptr<Fixed> fixed_;
  int poses_, batches_;
  std::unique_ptr<double[], Free> input_;  // [batch][6 readings, 9 rotation, 3 position][lane]
};

}  // namespace talus::bench
