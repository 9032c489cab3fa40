// talus_bench: the speed of Talus and of its peers on the 38-parameter spatial linkage.
//
//     talus_bench [Google Benchmark's options]    times everything
//     talus_bench --verify                        do the hand-written peers agree?
//     talus_bench --memory SOLVER POSES           peak memory of one calibration, in a fresh
//     process talus_bench --recordings POSES FILE         the poses of the benchmarks as CSV
#include "tests/bench/bench.h"

#include <sys/resource.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <span>
#include <stdexcept>
#include <vector>

namespace talus::bench {
namespace {

std::map<std::string, Calibrator>& calibrators() {
  static std::map<std::string, Calibrator> all;
  return all;
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

int pose_count(const char* text) {
  int count = 0;
  const char* end = text + std::strlen(text);
  if (std::from_chars(text, end, count).ptr != end || count < 1)
    throw std::runtime_error(std::string("not a number of poses: ") + text);
  return count;
}

int verify() {
  const double difference = peers_differ();
  const bool agree = difference < 1e-10;
  std::printf("largest difference of the peers: %.1e (%s)\n", difference,
              agree ? "they agree" : "too much");
  return agree ? 0 : 1;
}

int memory(const std::string& solver, int count) {
  const auto found = calibrators().find(solver);
  if (found == calibrators().end()) throw std::runtime_error("no solver is called " + solver);
  const IslPoses poses = isl_poses(count);
  const double before = peak_megabytes();
  const Calibration fit = found->second(poses, isl_published_factors());
  std::printf("%s, %d poses: peak %.0f MB (%.0f MB before calibrating), %.3g s, cost %.9g\n",
              solver.c_str(), count, peak_megabytes(), before, fit.seconds, fit.final_cost);
  return 0;
}

int run(std::span<char*> arguments) {
  const std::string mode = arguments.size() > 1 ? arguments[1] : "";
  if (mode == "--verify" && arguments.size() == 2) return verify();
  if (mode == "--memory" && arguments.size() == 4)
    return memory(arguments[2], pose_count(arguments[3]));
  if (mode == "--recordings" && arguments.size() == 4) {
    write_isl_recordings(arguments[3], isl_poses(pose_count(arguments[2])));
    return 0;
  }
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  if (peers_differ() >= 1e-10) throw std::runtime_error("the peers disagree; try --verify");
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace

void least(benchmark::internal::Benchmark* row) {
  row->ComputeStatistics("least", [](const std::vector<double>& all) {
    return *std::min_element(all.begin(), all.end());
  });
}

bool add_calibrator(const std::string& name, Calibrator calibrate) {
  calibrators()[name] = calibrate;
  benchmark::RegisterBenchmark(("calibrate/" + name).c_str(),
                               [calibrate](benchmark::State& state) {
                                 const IslPoses poses = isl_poses(static_cast<int>(state.range(0)));
                                 Calibration fit;
                                 for (auto _ : state) {
                                   fit = calibrate(poses, isl_published_factors());
                                   state.SetIterationTime(fit.seconds);
                                 }
                                 if (!fit.converged) state.SkipWithError("did not converge");
                                 state.counters["cost"] = fit.final_cost;
                                 state.counters["steps"] = fit.iterations;
                               })
      ->Arg(45)
      ->Arg(1000)
      ->Arg(10000)
      ->Arg(100000)
      ->Unit(benchmark::kMillisecond)
      ->UseManualTime()
      ->Apply(least);
  return true;
}

}  // namespace talus::bench

int main(int count, char** arguments) try {
  return talus::bench::run({arguments, static_cast<std::size_t>(count)});
} catch (const std::exception& problem) {
  std::fprintf(stderr, "talus_bench: %s\n", problem.what());
  return 2;
}
