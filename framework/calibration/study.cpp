#include "framework/calibration/study.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <random>

#include "framework/calibration/parallel.h"

namespace talus {
namespace {

// A seed of its own for each trial of each design (splitmix64).
std::uint64_t mixed(std::uint64_t seed, std::uint64_t design, std::uint64_t trial) {
  std::uint64_t z = seed * 0x9e3779b97f4a7c15u + (design << 32) + trial + 0x632be59bd9b4e019u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

ProblemOptions alone() {
  ProblemOptions options;
  options.robust = false;
  return options;
}

}  // namespace

StudiedMotion::StudiedMotion(const Program& program, const Settings& settings,
                             const Choices& choices)
    : program_(&program),
      finder_(program, choices.of, choices.reverse),
      poses_(simulate(program, settings, {.noise = 0})),
      rows_(poses_.rows()),
      plan_(plan_for(program, Groups(program, poses_), alone())) {
  std::iota(rows_.begin(), rows_.end(), std::size_t{0});
  if (!program.readings.empty())
    throw InputError(program.readings[0].place,
                     fmt::format("the motion reads a sensor, '{}'", program.readings[0].sensor),
                     "hinges moved by an <unknown> per pose: the linkage does the measuring");
  for (const Parameter& p : program.parameters) start_.push_back(p.nominal.value);
  latent_.resize(static_cast<Eigen::Index>(rows_.size()),
                 static_cast<Eigen::Index>(program.unknowns.size()));
  for (std::size_t k = 0; k < rows_.size(); ++k)
    for (std::size_t i = 0; i < program.unknowns.size(); ++i)
      latent_(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = settings.poses[k][i];
  LocateOptions once;
  once.fit.restarts = 0;
  Located reference = finder_.locate(poses_, rows_, once);
  views_ = finder_.body_views(reference);
  finder_.describe(reference, views_);
  for (std::size_t k = 0; k < finder_.hinges().size(); ++k)
    if (!reference.axes[k].determined)
      throw InputError(
          {program.name, 0, 0},
          fmt::format("axis '{}' is {}", finder_.hinges()[k].name, reference.axes[k].why),
          "a motion that determines it");
  // The truth is where the model says, not where it was found again.
  reference.fit.x = start_;
  if (choices.anatomical)
    views_ = finder_.anatomical_views(
        reference, choices.by.empty() ? finder_.hinges()[0].name : choices.by,
        std::vector<double>(program.unknowns.size(), 0), {"--frames anatomical", 0, 0});
  truth_ = numbers(finder_, start_);
}

std::vector<double> StudiedMotion::numbers(AxisFinder& finder,
                                           std::span<const double> parameters) const {
  std::vector<double> out;
  const std::vector<Line> lines = finder.lines(parameters);
  for (std::size_t k = 0; k < lines.size(); ++k)
    for (double v : coordinates_of(lines[k], views_[k])) out.push_back(v);
  return out;
}

std::vector<double> StudiedMotion::errors(AxisFinder& finder,
                                          const std::vector<Eigen::Isometry3d>& measured) const {
  Recordings table = poses_;
  set_frame_columns(table, *program_, finder.feature().columns, measured);
  Problem problem(*program_, plan_, table, rows_, Groups(*program_, table), alone());
  problem.set_latents(latent_);
  std::vector<double> x = start_;
  std::vector<double> result(truth_.size(), std::nan(""));
  if (!std::isfinite(solve(problem, x).final_cost)) return result;
  result = numbers(finder, x);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] -= truth_[i];
  return result;
}

StudiedDesign::StudiedDesign(Program& linkage, const StudiedMotion& motion, int threads)
    : linkage_(&linkage),
      motion_(&motion),
      reached_(recover(linkage, motion.poses(), Reach::if_possible, threads)),
      poses_(linkage, motion.finder().feature()) {}

StudyRow StudiedDesign::run(double noise, std::uint64_t design, const StudyOptions& options) const {
  StudyRow row;
  row.outside = reached_.count(Recovered::How::outside);
  row.unreachable = reached_.count(Recovered::How::not_at_all);
  const std::size_t numbers = 4 * motion_->finder().hinges().size();
  row.rmse.assign(numbers, std::nan(""));
  row.error.assign(numbers, std::nan(""));
  if (row.unreachable > 0) return row;

  struct Worker {
    LinkagePoses linkage;
    AxisFinder finder;
  };
  std::vector<Worker> workers(static_cast<std::size_t>(std::max(1, options.threads)),
                              {poses_, motion_->finder()});
  std::vector<std::vector<double>> errors(static_cast<std::size_t>(options.trials));
  std::atomic<int> done{0};
  parallel_chunks(options.trials, options.threads, [&](int trial, int worker) {
    Worker& own = workers[worker];
    std::mt19937_64 random(mixed(options.seed, design, static_cast<std::uint64_t>(trial)));
    std::normal_distribution<double> normal;
    std::vector<Eigen::Isometry3d> measured;
    for (std::vector<double> readings : reached_.settings.poses) {
      for (std::size_t i = 0; i < linkage_->readings.size(); ++i)
        readings[i] +=
            (linkage_->readings[i].dimension == angle ? noise : linkage_->readings[i].sigma) *
            normal(random);
      measured.push_back(own.linkage(readings));
    }
    errors[trial] = motion_->errors(own.finder, measured);
    if (options.progress) options.progress(static_cast<double>(++done) / options.trials);
  });

  for (const auto& e : errors) row.trials += std::isfinite(e[0]);
  const auto n = static_cast<double>(row.trials);
  for (std::size_t i = 0; i < numbers; ++i) {
    double squares = 0, fourth = 0;
    for (const auto& e : errors)
      if (std::isfinite(e[0])) squares += e[i] * e[i], fourth += std::pow(e[i], 4);
    const double mean = squares / n;
    row.rmse[i] = std::sqrt(mean);
    // The standard error of a mean square, carried through the root.
    row.error[i] =
        mean > 0 && n > 1
            ? std::sqrt(std::max(0.0, fourth / n - mean * mean) / (n - 1)) / (2 * row.rmse[i])
            : 0;
  }
  return row;
}

}  // namespace talus
