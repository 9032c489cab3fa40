// How a solver enters the comparison. One line puts it into all rows and modes of talus_bench:
//
//     const bool added = add_calibrator("autodiff", calibrate_autodiff);
//
// It is then timed as calibrate/autodiff/45 .. /100000, its cost and iterations are shown beside
// the time, and `talus_bench --memory autodiff 100000` tells the memory it needs. Only what the
// solver itself reports as seconds counts, so it may bring the poses into its own form first.
#pragma once

#include <benchmark/benchmark.h>

#include <string>

#include "tests/bench/isl_data.h"

namespace talus::bench {

using Calibrator = Calibration (*)(const IslPoses&, const IslFactors&);

bool add_calibrator(const std::string& name, Calibrator calibrate);

// With --benchmark_repetitions=9 the least time is shown too: BENCHMARK(...)->Apply(least). On a
// machine that others use it says more than the mean.
void least(benchmark::internal::Benchmark* row);

// Largest difference of the SIMD peer's rows and Gram matrix from those by automatic
// differentiation, over 1,003 poses at nominal and published parameters, relative to 1 + |value|.
double peers_differ();

}  // namespace talus::bench
