#include "tests/bench/isl_peer_limit.h"

#include <Eigen/Cholesky>
#include <chrono>
#include <xsimd/xsimd.hpp>

namespace talus::bench {
namespace {

using Batch = xsimd::batch<double>;
constexpr int width = static_cast<int>(Batch::size);
constexpr int tile = 2;   // batches at a time
constexpr int block = 4;  // columns at a time
constexpr int blocks = 10;
constexpr int turning = 6;  // the first blocks, which are not zero in the angles' rows
constexpr int batch_size = isl_rows * IslSimd::columns * width;

// Turns and the residual first, then shifts; filled up to 40 by one column named twice.
constexpr int order[blocks * block] = {3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15, 16,
                                       17, 18, 19, 20, 21, 35, 36, 37, 38, 0,  1,  2,  22, 23,
                                       24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 34};

using Sums = std::array<Batch, block * block>;

template <int rows>
inline void add_block(const double* from, int left, int right, Sums& to) {
  const double* a[block];
  const double* b[block];
  for (int i = 0; i < block; ++i) {
    a[i] = from + order[left * block + i] * width;
    b[i] = from + order[right * block + i] * width;
  }
  Sums sums = to;
  for (int t = 0; t < tile; ++t)
    for (int row = 0; row < rows; ++row) {
      const int offset = t * batch_size + row * IslSimd::columns * width;
      Batch v[block];
      for (int j = 0; j < block; ++j) v[j] = Batch::load_aligned(b[j] + offset);
      for (int i = 0; i < block; ++i) {
        const Batch u = Batch::load_aligned(a[i] + offset);
        for (int j = 0; j < block; ++j) sums[i * block + j] += u * v[j];
      }
    }
  to = sums;
}

}  // namespace

IslGram isl_gram(const IslSimd& simd) {
  alignas(64) double rows[tile * batch_size];
  std::array<Sums, blocks*(blocks + 1) / 2> sums;
  for (Sums& of_block : sums) of_block.fill(Batch(0.));
  for (int first = 0; first < simd.batches(); first += tile) {
    const int count = std::min(tile, simd.batches() - first);
    simd.evaluate(first, count, rows);
    std::fill(rows + count * batch_size, rows + tile * batch_size, 0.);
    Sums* to = sums.data();
    for (int left = 0; left < blocks; ++left)
      for (int right = left; right < blocks; ++right, ++to)
        if (right < turning)
          add_block<6>(rows, left, right, *to);
        else
          add_block<3>(rows, left, right, *to);
  }
  IslGram gram;
  const Sums* from = sums.data();
  for (int left = 0; left < blocks; ++left)
    for (int right = left; right < blocks; ++right, ++from)
      for (int i = 0; i < block; ++i)
        for (int j = 0; j < block; ++j) {
          const int row = order[left * block + i], column = order[right * block + j];
          gram(row, column) = gram(column, row) = xsimd::hadd((*from)[i * block + j]);
        }
  return gram;
}

Calibration calibrate_limit(const IslPoses& poses, const IslFactors& factors) {
  const auto start = std::chrono::steady_clock::now();
  constexpr int n = isl_parameters;
  IslSimd simd(poses, factors);
  Calibration result;
  result.parameters = isl_nominal();
  simd.set(result.parameters);
  IslGram gram = isl_gram(simd);
  result.initial_cost = result.final_cost = gram(n, n) / 2;

  double radius = 1e4;
  for (int tries = 0; tries < 100 && !result.converged; ++tries) {
    Eigen::Matrix<double, n, n> damped = gram.topLeftCorner<n, n>();
    damped.diagonal() *= 1 + 1 / radius;
    const Eigen::Matrix<double, n, 1> step = damped.ldlt().solve(gram.col(n).head<n>());
    IslParameters next = result.parameters;
    for (int i = 0; i < n; ++i) next[i] -= step[i];
    simd.set(next);
    const IslGram there = isl_gram(simd);
    const double cost = there(n, n) / 2;
    result.converged = std::abs(result.final_cost - cost) < 1e-9 * result.final_cost;
    if (cost < result.final_cost) {
      radius *= 3;
      gram = there;
      result.parameters = next;
      result.final_cost = cost;
      ++result.iterations;
    } else {
      radius /= 4;
    }
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace talus::bench
