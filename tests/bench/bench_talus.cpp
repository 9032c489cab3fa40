// Talus's own rows: the shipped linkage model, compiled once, on the same poses and weights as the
// peers.
#include <chrono>
#include <cmath>
#include <numeric>

#include "framework/calibration/solve.h"
#include "framework/dsl/dsl.h"
#include "tests/bench/bench.h"

namespace talus::bench {
namespace {

// The shipped model with the papers' residuals and weights; `joint` is the joint's tag. Tolerances
// are left out of the cost (ProblemOptions::priors), as the peers have none.
Program isl_program(const std::string& joint = "dh") {
  Registry registry = Registry::built_in();
  if (joint != "dh") load_plugin(TALUS_BENCH_DIR "/dh_in_lua.lua", registry);
  Model model = read_model(TALUS_BENCH_DIR "/../../models/isl-bonny-2013/model.xml", registry);
  for (Element& child : model.root.children) {
    if (child.tag == "chain")
      for (Element& element : child.children)
        if (element.tag == "dh") element.tag = joint;
    if (child.tag == "encoder") child.set("sigma", "0");
    if (child.tag == "calibrate") {
      child.set("residual", "position, projection_angles");
      child.set("weight", "0.35, 0.65");
    }
  }
  return compile(model, registry);
}

const Program& program() {
  static const Program p = isl_program();
  return p;
}

Recordings recordings_of(const IslPoses& poses) {
  Recordings r;
  auto column = [&](const std::string& name, const char* unit, auto value) {
    RecordedColumn c{name, *parse_unit(unit), {}, {}};
    c.values.reserve(poses.size());
    for (const IslPose& p : poses) c.values.push_back(value(p));
    r.columns.push_back(std::move(c));
  };
  for (int i = 0; i < 6; ++i)
    column("theta" + std::to_string(i + 1), "rad", [i](const IslPose& p) { return p.readings[i]; });
  for (int i = 0; i < 3; ++i)
    column(std::string("E.") + "xyz"[i], "mm", [i](const IslPose& p) { return p.position[i]; });
  for (int i = 0; i < 4; ++i)
    column(std::string("E.q") + "wxyz"[i], "1", [i](const IslPose& p) {
      // Shepperd's method, largest component first.
      const auto& R = p.rotation;
      const double t[4] = {R[0] + R[4] + R[8], R[0] - R[4] - R[8], R[4] - R[0] - R[8],
                           R[8] - R[0] - R[4]};
      int k = 0;
      for (int j = 1; j < 4; ++j) k = t[j] > t[k] ? j : k;
      const double s = 2 * std::sqrt(1 + t[k]);
      const double skew[3] = {R[7] - R[5], R[2] - R[6], R[3] - R[1]};
      if (i == k) return s / 4;
      if (k == 0) return skew[i - 1] / s;
      if (i == 0) return skew[k - 1] / s;
      return (R[3 * (k - 1) + i - 1] + R[3 * (i - 1) + k - 1]) / s;
    });
  r.lines.resize(poses.size());
  std::iota(r.lines.begin(), r.lines.end(), 2);
  return r;
}

std::vector<std::size_t> all_rows(const Recordings& r) {
  std::vector<std::size_t> rows(r.rows());
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

Calibration calibrate_with(const Program& p, const IslPoses& poses) {
  const Recordings recordings = recordings_of(poses);
  const std::vector<std::size_t> rows = all_rows(recordings);
  const Groups groups(p, recordings);
  ProblemOptions options;
  options.priors = false;
  const Plan plan = plan_for(p, groups, options);
  const auto begin = std::chrono::steady_clock::now();
  Problem problem(p, plan, recordings, rows, groups, options);
  std::vector<double> x = problem.start();
  SolveOptions solver;
  solver.function_tolerance = 1e-9;
  const SolveReport report = solve(problem, x, solver);
  Calibration result;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  result.initial_cost = report.initial_cost;
  result.final_cost = report.final_cost;
  result.iterations = report.iterations;
  result.converged = report.converged;
  return result;
}

Calibration calibrate_talus(const IslPoses& poses, const IslFactors&) {
  return calibrate_with(program(), poses);
}

Calibration calibrate_lua(const IslPoses& poses, const IslFactors&) {
  static const Program p = isl_program("dh_in_lua");
  return calibrate_with(p, poses);
}

const bool added = add_calibrator("talus", calibrate_talus);
const bool added_lua = add_calibrator("talus_lua_joint", calibrate_lua);

// Residual and Jacobian of all poses, batch after batch into a block that stays in the cache.
void jacobian(benchmark::State& state, const Program& p) {
  const IslPoses poses = isl_poses(static_cast<int>(state.range(0)));
  const Recordings recordings = recordings_of(poses);
  const Groups groups(p, recordings);
  std::vector<int> slots;
  for (const Parameter& parameter : p.parameters) slots.push_back(parameter.slot);
  const Plan plan(p, {slots}, {});
  const Dataset data(p, plan, recordings, all_rows(recordings), groups);
  Buffer workspace = plan.workspace();
  const std::size_t block = static_cast<std::size_t>(plan.rows()) * lanes;
  Buffer J(block * slots.size()), weights(block, 2.0);
  std::vector<double> values(p.slots, 0.0);
  for (const Parameter& parameter : p.parameters) values[parameter.slot] = parameter.nominal.value;
  for (auto _ : state) {
    plan.set_parameters(workspace, values);
    for (int b = 0; b < data.batches(); ++b) {
      plan.evaluate(workspace, data.data(b), nullptr);
      plan.jacobian(workspace, 0, {RowTransform::Kind::diagonal, weights.data()}, J.data(), block);
      benchmark::ClobberMemory();
    }
  }
  state.counters["per_pose"] = benchmark::Counter(
      static_cast<double>(poses.size()),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
void jacobian_talus(benchmark::State& state) { jacobian(state, program()); }
void jacobian_lua(benchmark::State& state) {
  static const Program p = isl_program("dh_in_lua");
  jacobian(state, p);
}
BENCHMARK(jacobian_talus)->Name("jacobian/talus")->Arg(1000)->Apply(least);
BENCHMARK(jacobian_lua)->Name("jacobian/talus_lua_joint")->Arg(1000)->Apply(least);

// With the Gram matrix and its factor: one evaluation as the solver asks for it.
void normal_talus(benchmark::State& state) {
  const IslPoses poses = isl_poses(static_cast<int>(state.range(0)));
  const Recordings recordings = recordings_of(poses);
  ProblemOptions options;
  options.priors = false;
  Problem problem(program(), recordings, all_rows(recordings), Groups(program(), recordings),
                  options);
  for (auto _ : state) benchmark::DoNotOptimize(problem.normal(problem.start()).cost);
  state.counters["per_pose"] = benchmark::Counter(
      static_cast<double>(poses.size()),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(normal_talus)->Name("gram/talus")->Arg(1000)->Apply(least);

// Once per model, whatever the number of poses.
void compile_talus(benchmark::State& state) {
  for (auto _ : state) {
    const Program p = isl_program();
    std::vector<int> slots;
    for (const Parameter& parameter : p.parameters) slots.push_back(parameter.slot);
    benchmark::DoNotOptimize(Plan(p, {slots}, {}).rows());
  }
}
BENCHMARK(compile_talus)->Name("compile/talus")->Apply(least);

}  // namespace
}  // namespace talus::bench
