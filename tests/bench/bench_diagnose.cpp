// A whole diagnosis of the shipped linkage, as the command runs it: faults, blunders, search,
// refits, held-out rows, what could have been seen, and the poses to record next. One effect is in
// the truth, or none. Readings are drawn within those of the shipped recordings; two threads.
#include <algorithm>

#include "framework/calibration/simulate.h"
#include "framework/diagnosis/advice.h"
#include "framework/dsl/dsl.h"
#include "tests/bench/bench.h"

namespace talus::bench {
namespace {

constexpr const char* home = TALUS_BENCH_DIR "/../../models/isl-bonny-2013/";
constexpr int kThreads = 2;

Recordings recorded(Registry& registry, int poses, const std::string& effect) {
  Model truth = read_model(std::string(home) + "published.xml", registry);
  for (const Element& e :
       read_xml("<talus>" + effect + "</talus>", "effect.xml", registry).root.children)
    truth.root.children.push_back(e);
  Program program = compile(truth, registry);
  const Recordings shipped = read_recordings(std::string(home) + "recordings.csv");
  for (Reading& r : program.readings) {
    const std::vector<double>& values = shipped.get(r.column, r.dimension).values;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    r.range = {*low, *high};
  }
  return simulate(program, random_settings(program, poses, 3), {5, 1, kThreads});
}

void diagnosis(benchmark::State& state, const std::string& effect) {
  Registry registry = Registry::built_in();
  const Model model = read_model(std::string(home) + "model.xml", registry);
  const Recordings recordings = recorded(registry, static_cast<int>(state.range(0)), effect);
  const Split split = split_rows(recordings, {});
  DiagnosisOptions options;
  options.fit.threads = kThreads;
  AdviceOptions advice;
  advice.threads = kThreads;
  for (auto _ : state) {
    const Diagnosis d = diagnose(model, registry, recordings, split, options);
    benchmark::DoNotOptimize(advise(model, registry, d, advice));
    state.SetLabel(to_string(d.verdict));
  }
}

void none(benchmark::State& state) { diagnosis(state, ""); }
void one(benchmark::State& state) {
  diagnosis(state, "<encoder_eccentricity at='encoder1' sine='0.5' cosine='0.5'/>");
}

BENCHMARK(none)
    ->Name("diagnose/none")
    ->Arg(65)
    ->Arg(2000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Apply(least);
BENCHMARK(one)
    ->Name("diagnose/one")
    ->Arg(65)
    ->Arg(2000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Apply(least);

}  // namespace
}  // namespace talus::bench
