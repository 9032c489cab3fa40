#include "framework/diagnosis/noise.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "framework/diagnosis/neighbours.h"
#include "framework/diagnosis/noise_sources.h"
#include "framework/diagnosis/pose_blocks.h"
#include "framework/diagnosis/tails.h"

namespace talus {
namespace {

// Chance of calling good noise wrong; a noise that is off by less than this is not worth a word.
constexpr double surely = 1e-4;
constexpr double noticeable = 1.1;
// The fourth power's sum has a long upper tail: of 150 good poses one in some thousands exceeds
// five of its standard deviations.
constexpr double heavy_beyond = 5;
constexpr int lags = 2;  // neighbours on one side that are compared
// A statement on order needs some poses.
constexpr std::size_t fewest = 15;

struct Pose {
  Eigen::VectorXd rows;  // of unit covariance, as stated
  double square = 0, freedom = 0;
};

struct Order {
  std::string name;
  double z_mean = 0, z_size = 0, correlation = 0;
};

// Do neighbours resemble each other? Products of neighbours over the root of the sum of their
// squares: standard normal where they do not, whatever the tails.
Order resemblance(const PoseOrder& order, const std::vector<Pose>& poses, double scale2) {
  std::vector<int> sorted;
  for (std::size_t k = 0; k < poses.size(); ++k)
    if (!std::isnan(order.values[k]) && poses[k].freedom > 0) sorted.push_back(static_cast<int>(k));
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](int a, int b) { return order.values[a] < order.values[b]; });
  double mean = 0, mean2 = 0, size = 0, size2 = 0, next = 0, all = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const Pose& a = poses[sorted[i]];
    all += a.square;
    for (std::size_t j = i + 1; j < std::min(sorted.size(), i + 1 + lags); ++j) {
      const Pose& b = poses[sorted[j]];
      const double product = a.rows.dot(b.rows),
                   sizes = (a.square / scale2 - a.freedom) * (b.square / scale2 - b.freedom);
      mean += product, mean2 += product * product;
      size += sizes, size2 += sizes * sizes;
      if (j == i + 1) next += product;
    }
  }
  Order result{order.name};
  if (sorted.size() < fewest || !(mean2 > 0)) return result;
  result.z_mean = mean / std::sqrt(mean2);
  result.z_size = size2 > 0 ? size / std::sqrt(size2) : 0;
  result.correlation = next / all;
  return result;
}

double upper_tail(double z) { return std::erfc(z / std::sqrt(2.0)) / 2; }

std::string times(double ratio) { return fmt::format("{:.2g} times", ratio); }

std::string in_order(const std::string& name) {
  return name == "order" ? "the order of recording" : name;
}

void whiteness(NoiseVerdict& v, const std::vector<PoseOrder>& orders,
               const std::vector<Pose>& poses) {
  double least_mean = 0, least_size = 0;
  std::string mean, size;
  for (const PoseOrder& order : orders) {
    const Order o = resemblance(order, poses, v.scale * v.scale);
    if (order.name == "order") v.correlation = o.correlation;
    if (o.z_mean > least_mean) least_mean = o.z_mean, mean = order.name;
    if (o.z_size > least_size) least_size = o.z_size, size = order.name;
  }
  const auto tried = static_cast<double>(orders.size());
  v.p_white = std::min(1.0, tried * upper_tail(least_mean));
  v.p_even = std::min(1.0, tried * upper_tail(least_size));
  if (v.p_white < surely) v.unwhite = mean;
  if (v.p_even < surely) v.uneven = size;
}

void tails(NoiseVerdict& v, const std::vector<Pose>& poses) {
  double fourth = 0, expected = 0;
  for (const Pose& p : poses) {
    fourth += std::pow(p.square / (v.scale * v.scale), 2);
    expected += p.freedom * (p.freedom + 2);
  }
  if (!(expected > 0)) return;
  const double ratio = fourth / expected;
  v.kurtosis = 3 * ratio;
  v.heavy = fourth - expected > heavy_beyond * std::sqrt(8 * expected) && poses.size() >= fewest;
  // Of Student's t: (n - 2) / (n - 4).
  if (v.heavy) v.student = (4 * ratio - 2) / (ratio - 1);
}

void say(NoiseVerdict& v, bool noise_known, const std::string& measured) {
  auto fault = [&](const char* kind, const std::string& where, std::string statement) {
    v.statement += (v.statement.empty() ? "" : " ") + statement;
    v.faults.push_back({kind, where, std::move(statement)});
  };
  if (!v.unwhite.empty()) {
    v.statement = fmt::format(
        "What is left is not noise alone: poses that are neighbours in {} misfit alike.",
        in_order(v.unwhite));
    if (v.unwhite == "order")
      v.statement += fmt::format(" (Correlation from one to the next: {:.2f}.)", v.correlation);
  } else if (v.source) {
    fault("noise-larger-than-stated", v.source->name,
          fmt::format("The noise of {} is {} the stated one; the rest is {}.", v.source->name,
                      times(v.source->ratio),
                      std::abs(std::log(v.source->rest)) < std::log(noticeable)
                          ? std::string("as stated")
                          : times(v.source->rest) + " what is stated"));
  } else if (v.larger) {
    fault("noise-larger-than-stated", measured,
          fmt::format("The noise is {} the stated one, and nothing else shows.", times(v.scale)));
  } else if (v.smaller) {
    fault("noise-smaller-than-stated", measured,
          fmt::format("The noise is only {} the stated one: stated too large, values that were "
                      "smoothed, or made smaller by a wrong unit.",
                      times(v.scale)));
  }
  if (v.heavy)
    fault(
        "heavy-tails", measured,
        fmt::format("Large errors are more frequent than Gaussian noise has them (kurtosis {:.2g} "
                    "instead of 3, as of Student's t with {:.1f} degrees of freedom).",
                    v.kurtosis, *v.student));
  if (!v.uneven.empty() && v.unwhite.empty())
    fault("uneven-noise", measured,
          fmt::format("The noise is not the same everywhere: its size changes with {}.",
                      in_order(v.uneven)));
  if (v.statement.empty())
    v.statement = noise_known ? "What is left is noise, and as much as was stated."
                              : "What is left is noise.";
}

}  // namespace

NoiseVerdict judge_noise(const Program& program, const Recordings& recordings,
                         const std::vector<std::size_t>& rows, std::span<const double> x,
                         const FaultOptions& options) {
  NoiseVerdict v;
  const Groups groups(program, recordings);
  ProblemOptions plain;
  plain.threads = options.threads;
  plain.robust = false;
  Problem problem(program, recordings, rows, groups, plain);
  if (program.settings.full_scale) problem.divide_rows_by(full_scale_ranges(program, recordings));
  if (problem.latents() > 0) problem.scatter_latents(x, options.seed);
  problem.set_weights(x);
  const Problem::Residuals residuals = problem.residuals(x);
  if (!problem.noise_known()) {
    std::vector<double> squares;
    for (Eigen::Index k = 0; k < residuals.whitened.rows(); ++k)
      squares.push_back(residuals.whitened.row(k).squaredNorm() /
                        static_cast<double>(residuals.whitened.cols()));
    problem.set_noise_variance(std::max(1e-300, median(squares)));
  }
  const std::vector<bool> all(rows.size(), true);
  const PoseBlocks blocks(problem, problem.linear(x), x, all);
  const PoseBlocks::Solution solution = blocks.fit(all);
  std::vector<Pose> poses;
  double squares = 0, freedom = 0, taken = 0, standard = 0;
  for (int k = 0; k < blocks.poses(); ++k) {
    Pose pose{blocks.standardised(solution, k), 0, blocks.freedom(k)};
    pose.square = pose.rows.squaredNorm();
    squares += blocks.squares(solution, k);
    standard += pose.square;
    freedom += pose.freedom;
    taken += blocks.leverage(solution, k);
    poses.push_back(std::move(pose));
  }
  if (!(freedom - taken > 0) || !(squares > 0)) {
    v.statement = "Nothing is left to judge the noise by.";
    return v;
  }
  v.scale = std::sqrt(standard / freedom);
  const double log_upper = log_chi2_tail(squares, freedom - taken);
  v.p = v.scale > 1 ? std::exp(log_upper) : -std::expm1(log_upper);
  std::vector<PoseOrder> orders = pose_orders(recordings, residuals.poses, {});
  for (Eigen::Index i = 0; i < residuals.latent.cols(); ++i) {
    const auto values = residuals.latent.col(i);
    const Unknown& unknown = program.unknowns[groups.latent[i]];
    orders.push_back({unknown.name, {values.begin(), values.end()}});
  }
  whiteness(v, orders, poses);
  tails(v, poses);
  if (problem.noise_known()) {
    const bool white = v.unwhite.empty();
    v.larger = white && v.p < surely && v.scale > noticeable;
    v.smaller = v.p < surely && v.scale < 1 / noticeable;
    std::vector<Eigen::VectorXd> of_poses;
    for (Pose& p : poses) of_poses.push_back(std::move(p.rows));
    if (white) v.source = noisier_source(problem.noise(x), of_poses);
  } else {
    v.p = 1;
  }
  std::vector<std::string> measured;
  for (const Feature& f : program.features) measured.push_back(f.name);
  say(v, problem.noise_known(), join(measured));
  return v;
}

}  // namespace talus
