// The peers' rows: hand-written Ceres with automatic differentiation, and the limit in SIMD.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "tests/bench/bench.h"
#include "tests/bench/isl_peer_autodiff.h"
#include "tests/bench/isl_peer_limit.h"
#include "tests/bench/isl_peer_simd.h"

namespace talus::bench {
namespace {

struct Free {
  void operator()(double* p) const { std::free(p); }
};
using Buffer = std::unique_ptr<double[], Free>;

Buffer buffer(std::size_t count) {
  return Buffer(
      static_cast<double*>(std::aligned_alloc(64, (count * sizeof(double) + 63) / 64 * 64)));
}

// Time per pose: Google Benchmark's inverse rate, shown with its own prefix (n for ns).
void count_poses(benchmark::State& state, int poses) {
  state.counters["per_pose"] = benchmark::Counter(
      poses, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void autodiff_jacobian(benchmark::State& state) {
  const IslPoses poses = isl_poses(static_cast<int>(state.range(0)));
  const IslAutodiff autodiff(poses, isl_published_factors());
  double residuals[isl_rows], jacobian[isl_rows * isl_parameters];
  for (auto _ : state)
    for (int i = 0; i < autodiff.poses(); ++i) {
      autodiff.evaluate(i, isl_nominal(), residuals, jacobian);
      benchmark::DoNotOptimize(jacobian);
    }
  count_poses(state, autodiff.poses());
}
BENCHMARK(autodiff_jacobian)->Name("jacobian/autodiff")->Arg(1000)->Apply(least);

// Into a block that stays in the nearest cache, as a solver does that consumes it at once.
void simd_jacobian(benchmark::State& state) {
  const IslPoses poses = isl_poses(static_cast<int>(state.range(0)));
  IslSimd simd(poses, isl_published_factors());
  const Buffer rows = buffer(isl_rows * IslSimd::columns * IslSimd::lanes);
  for (auto _ : state) {
    simd.set(isl_nominal());
    for (int i = 0; i < simd.batches(); ++i) {
      simd.evaluate(i, 1, rows.get());
      benchmark::ClobberMemory();
    }
  }
  count_poses(state, static_cast<int>(poses.size()));
  state.counters["lanes"] = IslSimd::lanes;
}
BENCHMARK(simd_jacobian)->Name("jacobian/simd")->Arg(1000)->Arg(100000)->Apply(least);

// Into one array for all poses.
void simd_jacobian_array(benchmark::State& state) {
  const IslPoses poses = isl_poses(static_cast<int>(state.range(0)));
  IslSimd simd(poses, isl_published_factors());
  const Buffer rows =
      buffer(std::size_t{isl_rows} * IslSimd::columns * IslSimd::lanes * simd.batches());
  for (auto _ : state) {
    simd.set(isl_nominal());
    simd.evaluate(0, simd.batches(), rows.get());
    benchmark::ClobberMemory();
  }
  count_poses(state, static_cast<int>(poses.size()));
}
BENCHMARK(simd_jacobian_array)->Name("jacobian/simd_array")->Arg(1000)->Arg(100000)->Apply(least);

// Residual, Jacobian and the Gram matrix of both.
void limit_gram(benchmark::State& state) {
  const IslPoses poses = isl_poses(static_cast<int>(state.range(0)));
  IslSimd simd(poses, isl_published_factors());
  for (auto _ : state) {
    simd.set(isl_nominal());
    benchmark::DoNotOptimize(isl_gram(simd));
  }
  count_poses(state, static_cast<int>(poses.size()));
}
BENCHMARK(limit_gram)->Name("gram/limit")->Arg(1000)->Arg(100000)->Apply(least);

const bool added =
    add_calibrator("autodiff", calibrate_autodiff) && add_calibrator("limit", calibrate_limit);

}  // namespace

double peers_differ() {
  const IslPoses poses = isl_poses(1003);
  const IslFactors factors = isl_published_factors();
  const IslAutodiff autodiff(poses, factors);
  IslSimd simd(poses, factors);
  const int lanes = IslSimd::lanes;
  const Buffer rows = buffer(isl_rows * IslSimd::columns * lanes);
  double worst = 0;
  const auto compare = [&](double expected, double found) {
    const double difference = std::abs(found - expected) / (1 + std::abs(expected));
    worst = std::max(worst, std::isnan(difference) ? INFINITY : difference);
  };
  for (const IslParameters& at : {isl_nominal(), isl_optimised()}) {
    simd.set(at);
    Eigen::Matrix<double, IslSimd::columns, IslSimd::columns> gram;
    gram.setZero();
    for (int i = 0; i < autodiff.poses(); ++i) {
      if (i % lanes == 0) simd.evaluate(i / lanes, 1, rows.get());
      double r[isl_rows], j[isl_rows * isl_parameters];
      autodiff.evaluate(i, at, r, j);
      for (int row = 0; row < isl_rows; ++row) {
        Eigen::Matrix<double, IslSimd::columns, 1> expected;
        expected << Eigen::Map<Eigen::VectorXd>(j + row * isl_parameters, isl_parameters), r[row];
        gram += expected * expected.transpose();
        for (int column = 0; column < IslSimd::columns; ++column)
          compare(expected[column], rows[(row * IslSimd::columns + column) * lanes + i % lanes]);
      }
    }
    const Eigen::MatrixXd difference = isl_gram(simd) - gram;
    const Eigen::VectorXd size = gram.diagonal().cwiseSqrt();
    for (int i = 0; i < IslSimd::columns; ++i)
      for (int k = 0; k < IslSimd::columns; ++k) compare(0, difference(i, k) / (size[i] * size[k]));
  }
  return worst;
}

}  // namespace talus::bench
