#include "framework/diagnosis/noise.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "framework/diagnosis/neighbours.h"
#include "framework/diagnosis/noise_sources.h"
#include "framework/diagnosis/pose_blocks.h"
#include "framework/diagnosis/tails.h"

namespace talus {
namespace {

// Chance of calling good noise wrong; a noise that is off by less than this is not worth a word.
constexpr double surely = 1e-4;
constexpr double noticeable = 1.1;
constexpr double plainly_less = 0.8;  // nor does less noise do harm
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

// Do neighbours resemble each other? Products of neighbours over the root of the sum of their
// squares: standard normal where they do not, whatever the tails. `next`: those of next neighbours.
struct Resemblance {
  double z = 0, next = 0;
};
template <class Product>
Resemblance resemblance(const std::vector<int>& sorted, Product product) {
  double sum = 0, squares = 0;
  Resemblance result;
  for (std::size_t i = 0; i < sorted.size(); ++i)
    for (std::size_t j = i + 1; j < std::min(sorted.size(), i + 1 + lags); ++j) {
      const double p = product(sorted[i], sorted[j]);
      sum += p, squares += p * p;
      if (j == i + 1) result.next += p;
    }
  if (sorted.size() >= fewest && squares > 0) result.z = sum / std::sqrt(squares);
  return result;
}

std::vector<int> in_order_of(const PoseOrder& order, const std::vector<Pose>& poses) {
  std::vector<int> sorted;
  for (std::size_t k = 0; k < poses.size(); ++k)
    if (!std::isnan(order.values[k]) && poses[k].freedom > 0) sorted.push_back(static_cast<int>(k));
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](int a, int b) { return order.values[a] < order.values[b]; });
  return sorted;
}

double upper_tail(double z) { return std::erfc(z / std::sqrt(2.0)) / 2; }

std::string times(double ratio) { return fmt::format("{:.2g} times", ratio); }

std::string in_order(const std::string& name) {
  return name == "order" ? "the order of recording" : name;
}

void whiteness(NoiseVerdict& v, const std::vector<PoseOrder>& orders,
               const std::vector<Pose>& poses, const Problem::Noise& noise) {
  const double scale2 = v.scale * v.scale;
  double z_mean = 0, z_size = 0, tried = 0, squares = 0;
  std::string mean, channel, size;
  for (const Pose& p : poses) squares += p.square;
  // What the rows say of the error of each source.
  std::vector<Eigen::VectorXd> said;
  for (std::size_t k = 0; k < noise.columns.size(); ++k)
    said.push_back(noise.columns[k].transpose() * poses[k].rows);
  for (const PoseOrder& order : orders) {
    const std::vector<int> sorted = in_order_of(order, poses);
    auto note = [&](double z, const std::string& in) {
      ++tried;
      if (z > z_mean) z_mean = z, mean = order.name, channel = in;
    };
    const Resemblance rows =
        resemblance(sorted, [&](int a, int b) { return poses[a].rows.dot(poses[b].rows); });
    note(rows.z, "");
    if (order.name == "order") v.correlation = rows.next / squares, v.p_order = upper_tail(rows.z);
    for (std::size_t s = 0; s < noise.sources.size(); ++s) {
      const auto i = static_cast<Eigen::Index>(s);
      if (noise.sources[s].sigma > 0)
        note(resemblance(sorted, [&](int a, int b) { return said[a][i] * said[b][i]; }).z,
             noise.sources[s].name);
    }
    const double z = resemblance(sorted, [&](int a, int b) {
                       return (poses[a].square / scale2 - poses[a].freedom) *
                              (poses[b].square / scale2 - poses[b].freedom);
                     }).z;
    if (z > z_size) z_size = z, size = order.name;
  }
  v.p_white = std::min(1.0, tried * upper_tail(z_mean));
  v.p_even = std::min(1.0, static_cast<double>(orders.size()) * upper_tail(z_size));
  if (v.p_white < surely) v.unwhite = mean, v.channel = channel;
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
        "What is left is not noise alone: poses that are neighbours in {} misfit alike{}.",
        in_order(v.unwhite),
        v.channel.empty() ? "" : ", most of all in what they say of " + v.channel);
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
  if (!v.uneven.empty())
    fault("uneven-noise", measured,
          fmt::format("The noise is not the same everywhere: its size changes with {}.",
                      in_order(v.uneven)));
  else if (v.heavy)
    fault(
        "heavy-tails", measured,
        fmt::format("Large errors are more frequent than Gaussian noise has them (kurtosis {:.2g} "
                    "instead of 3, as of Student's t with {:.1f} degrees of freedom).",
                    v.kurtosis, *v.student));
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
  std::vector<std::string> measured;
  for (const MeasuredColumn& c : program.columns) measured.push_back(c.name);
  std::vector<PoseOrder> orders = pose_orders(recordings, residuals.poses, measured);
  for (Eigen::Index i = 0; i < residuals.latent.cols(); ++i) {
    const auto values = residuals.latent.col(i);
    const Unknown& unknown = program.unknowns[groups.latent[i]];
    orders.push_back({unknown.name, {values.begin(), values.end()}});
  }
  Problem::Noise noise;
  if (problem.noise_known()) noise = problem.noise(x);
  whiteness(v, orders, poses, noise);
  tails(v, poses);
  if (problem.noise_known()) {
    const bool white = v.unwhite.empty();
    v.larger = white && v.p < surely && v.scale > noticeable;
    v.smaller = v.p < surely && v.scale < plainly_less;
    std::vector<Eigen::VectorXd> of_poses;
    for (Pose& p : poses) of_poses.push_back(std::move(p.rows));
    if (white) v.source = noisier_source(noise, of_poses);
  } else {
    v.p = v.scale = 1;
  }
  // What is not noise, or noise of different sizes, has heavy tails as well.
  if (!v.unwhite.empty() || v.source) {
    v.heavy = false, v.student.reset();
    v.uneven.clear();
  }
  std::vector<std::string> features;
  for (const Feature& f : program.features) features.push_back(f.name);
  say(v, problem.noise_known(), join(features));
  return v;
}

}  // namespace talus
