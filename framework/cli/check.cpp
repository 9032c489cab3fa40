#include <fmt/format.h>

#include <memory>

#include "framework/calibration/fit.h"
#include "framework/cli/commands.h"

namespace talus {
namespace {

std::string chain_text(const Program& program) {
  std::string out = "Frames\n";
  std::function<void(int, int)> branch = [&](int frame, int depth) {
    std::string names;
    for (const auto& [name, index] : program.frame_index)
      if (index == frame && name != program.frames[frame].name) names += " = " + name;
    out += fmt::format("  {:{}}{}{}\n", "", 2 * depth, program.frames[frame].name, names);
    for (std::size_t f = 0; f < program.frames.size(); ++f)
      if (program.frames[f].parent == frame) branch(static_cast<int>(f), depth + 1);
  };
  branch(0, 0);
  if (!program.limbs.empty()) out += "Limbs\n";
  for (const Limb& limb : program.limbs) {
    const Unit unit = program.units.of(length);
    const Eigen::Vector3d size = limb.size / unit.factor;
    out += fmt::format("  {:<14} {:.4g} x {:.4g} x {:.4g} {}, at {}\n", limb.name, size.x(),
                       size.y(), size.z(), unit.text, program.frames[limb.frame].name);
  }
  out += "Readings\n";
  for (const Reading& r : program.readings)
    out += fmt::format("  {:<14} {:<10} {}\n", r.sensor, r.column,
                       formula(r.value, program.slot_names));
  if (!program.unknowns.empty()) out += "Unknowns\n";
  for (const Unknown& u : program.unknowns)
    out += fmt::format("  {:<14} per {}\n", u.name, u.per.empty() ? "pose" : join(u.per));
  out += "Measured features\n";
  for (const Feature& f : program.features)
    out += fmt::format("  {:<14} {} of {} in {}\n", f.name, f.tag, program.chains[f.chain].at,
                       program.chains[f.chain].in);
  out += "Residual rows\n";
  for (const Row& row : program.rows)
    out += fmt::format("  {:<14} {}\n", row.measure,
                       row.sigma ? fmt::format("sigma {:.4g} {}",
                                               *row.sigma / program.units.of(row.dimension).factor,
                                               program.units.of(row.dimension).text)
                                 : "no stated sigma");
  out += fmt::format("{} free parameters\n", program.parameters.size());
  for (const Parameter& p : program.parameters)
    out += fmt::format("  {:<20} {} {}\n", p.name,
                       write_quantity(p.nominal, p.dimension, program.units),
                       program.units.of(p.dimension).text);
  return out;
}

void run(const std::string& model_file, const std::string& recordings_file, const Common& common) {
  Registry registry = common.registry();
  const Program program = compile(open_model(model_file, registry, common), registry);
  fmt::print("{}\n{}", program.name, chain_text(program));
  if (recordings_file.empty()) return;
  const Recordings recordings = read_recordings(recordings_file);
  std::vector<std::size_t> rows(recordings.rows());
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = k;
  Problem problem(program, recordings, rows, Groups(program, recordings), {});
  const Identifiability seen = identify(problem, problem.start(), 1, program.units);
  fmt::print("{} poses; at the nominal values {} of {} directions are seen\n", rows.size(),
             seen.seen, problem.size());
  for (const std::string& sentence : seen.unseen) fmt::print("  - {}\n", sentence);
  if (problem.data().missing()) fmt::print("{} residuals lack a value\n", problem.data().missing());
}

}  // namespace

void add_check(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "check", "parse and check a model, and recordings with it; print the chain");
  auto common = std::make_shared<Common>();
  auto files = std::make_shared<std::pair<std::string, std::string>>();
  command->add_option("model", files->first, "model file (.xml or .lua)")->required();
  command->add_option("recordings", files->second, "recordings (.csv or .trc)");
  add_common(*command, *common, true, false);
  command->callback([=] { run(files->first, files->second, *common); });
}

}  // namespace talus
