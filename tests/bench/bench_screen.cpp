// Screening of about 280 candidates (680 columns) on a chain of six hinges: what a diagnosis does
// before anything is refitted. One thread.
#include <benchmark/benchmark.h>

#include <map>

#include "framework/diagnosis/next_poses.h"
#include "framework/diagnosis/sensitivity.h"
#include "tests/diagnosis/synthetic.h"

namespace talus::bench {
namespace {

using testing::Chain;

const Chain& candidates(int poses) {
  static std::map<int, Chain> made;
  if (const auto found = made.find(poses); found != made.end()) return found->second;
  Chain c = testing::chain(poses, 0.6, 3);
  testing::suspect_all(c);
  int suspect = c.candidates.forms.back().suspect + 1;
  for (int joint = 0; joint < c.joints; ++joint)
    for (int order = 4; order < 9; ++order)
      for (const int first : {0, 3}) {
        Form form{.suspect = suspect++};
        for (const int d : {first, first + 1})
          for (const double phase : {0.0, std::numbers::pi / 2})
            form.columns.push_back(
                c.add(c.column(joint, d,
                               [&](int k) { return std::cos(order * c.theta(k, joint) - phase); }),
                      first == 0 ? 0.02 : 2e-4));
        c.candidates.forms.push_back(form);
      }
  return made.emplace(poses, std::move(c)).first->second;
}

void label(benchmark::State& state, const Chain& c) {
  state.SetLabel(std::to_string(c.candidates.forms.size()) + " candidates, " +
                 std::to_string(c.candidates.columns.cols()) + " columns");
}

void scores(benchmark::State& state) {
  const Chain& c = candidates(static_cast<int>(state.range(0)));
  label(state, c);
  for (auto _ : state) {
    const Screen screen(c.baseline, c.candidates);
    benchmark::DoNotOptimize(screen.suspects());
  }
}

void gate(benchmark::State& state) {
  const Chain& c = candidates(static_cast<int>(state.range(0)));
  const Screen screen(c.baseline, c.candidates);
  for (auto _ : state) benchmark::DoNotOptimize(screen.gate({.always = true}));
}

void sensitive(benchmark::State& state) {
  const Chain& c = candidates(static_cast<int>(state.range(0)));
  const Screen screen(c.baseline, c.candidates);
  for (auto _ : state) benchmark::DoNotOptimize(sensitivity(screen));
}

// Eight poses of a pool as large as the design, five pairs to be told apart.
void choose(benchmark::State& state) {
  const Chain& c = candidates(static_cast<int>(state.range(0)));
  std::vector<PoolPose> pool;
  for (int k = 0; k < c.poses; ++k)
    pool.push_back(
        {c.baseline.columns.middleRows(6 * k, 6), c.candidates.columns.middleRows(6 * k, 6)});
  std::vector<Target> targets;
  for (int i = 0; i < 5; ++i) targets.push_back({37 * i, {}, {37 * i + 1}});
  for (auto _ : state)
    benchmark::DoNotOptimize(next_poses(c.baseline, c.candidates, pool, targets));
}

BENCHMARK(scores)->Name("screen/scores")->Arg(65)->Arg(2000)->Unit(benchmark::kMillisecond);
BENCHMARK(gate)->Name("screen/gate")->Arg(65)->Arg(2000)->Unit(benchmark::kMillisecond);
BENCHMARK(sensitive)->Name("screen/sensitivity")->Arg(65)->Arg(2000)->Unit(benchmark::kMillisecond);
BENCHMARK(choose)->Name("screen/next_poses")->Arg(500)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace talus::bench
