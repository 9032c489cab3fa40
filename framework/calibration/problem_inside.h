// The inside of a calibration problem, shared by problem.cpp, normal.cpp and batch.cpp.
#pragma once

#include <algorithm>

#include "framework/calibration/parallel.h"
#include "framework/calibration/problem.h"

namespace talus {

// What one thread works with.
struct Bench {
  Buffer workspace;
  Buffer state;       // [state slot][lane]
  Buffer whitened;    // [row][lane]
  Buffer transform;   // [row][row][lane]
  Buffer columns;     // of latent unknowns or readings: [column][row][lane]
  Buffer panel;       // [column][batches of the panel][row][lane]
  Eigen::MatrixXd A;  // of one lane: the row transform, the rows, a column, a product
  Eigen::VectorXd r, u;
  Eigen::RowVectorXd product;
  double rho[lanes], rho1[lanes], alpha[lanes], squares[lanes];
};

struct Problem::Inside {
  // Column sets of the plan.
  enum Set { kGlobal = 0, kLatent = 1, kReadings = 2 };

  const Program& program;
  ProblemOptions options;
  Groups groups;
  std::vector<int> latent_slots, shared_slots, noisy_slots;
  std::vector<double> noise_variance;   // of the noisy readings
  std::vector<int> noisy_columns;       // of those among the measured columns: where each stands
                                        // in measured_noise
  MeasuredNoise carried;                // with features whose rows follow from one another
  const MeasuredNoise* measured_noise;  // this one, or that of the points; null: none
  std::vector<bool> by_columns;         // rows whose noise is that of such columns alone
  Plan plan;
  Dataset data;
  std::vector<double> start;
  std::vector<bool> occurs;  // of each entry of x
  std::vector<Quantity> quantities;
  std::vector<Dimension> dimensions;
  std::vector<int> offset;  // of each shared unknown's instances in x
  std::vector<Quantity> latent_prior;
  std::vector<Dimension> latent_dimensions;
  bool robust = true, qr = false, dense = false;
  bool pivoted = false;            // the whitening takes rows in an order of its own, pose by pose
  std::size_t dependent_rows = 0;  // that follow from others of their pose and tell nothing new
  double noise_variance_of_rows = 1;
  double mean_slope = 1;  // of the published objective: how much more it pulls than least squares
  double prior_weight() const { return noise_variance_of_rows * (robust ? mean_slope : 1); }
  Buffer weights;  // per batch: [row][lane], or [row][row][lane] where dense
  Buffer latent;   // per batch: [latent][lane], the last solution
  Buffer latent_trial;
  std::vector<Bench> benches;
  std::vector<double> row_factor;  // 1/sigma or the papers' weight, per row

  Inside(const Program& program, Plan plan, const Recordings& recordings,
         const std::vector<std::size_t>& rows, const Groups& groups, const ProblemOptions& options);

  int rows() const { return plan.rows(); }
  int size() const { return static_cast<int>(quantities.size()); }
  int parameters() const {
    return options.only_unknowns ? 0 : static_cast<int>(program.parameters.size());
  }
  std::vector<double> slots(std::span<const double> x) const;  // values at the parameters' slots
  std::vector<double> held;  // parameters' values where they are held

  std::size_t weight_block() const {
    return static_cast<std::size_t>(rows()) * (dense ? rows() : 1) * lanes;
  }
  RowTransform whitening(int b) const;

  void fill_weights();
  double latent_tolerance(int latent) const;

  // whitening.cpp
  void combined_covariance(Bench& bench, int b, std::size_t& dependent);

  // batch.cpp
  void load_state(Bench& bench, int b, std::span<const double> x) const;
  void evaluate(Bench& bench, int b);  // rows, whitened rows, squares; latent unknowns solved
  void whiten(Bench& bench, int b);
  void solve_latent(Bench& bench, int b);
  void losses(Bench& bench, int b, bool robust);  // rho, rho', alpha of the squares
  RowTransform transform(Bench& bench, int b,
                         bool robust);  // whitening, projection, robust correction
  double batch_cost(const Bench& bench, int b) const;

  std::vector<std::size_t> places() const;  // of each batch's lane: the place of its recorded row
  int chunks() const;
  double prior_cost(std::span<const double> x) const;
  Normal normal(std::span<const double> x, bool robust, bool priors);  // normal.cpp
  template <class F>
  void each_batch(std::span<const double> x, F f);
};

// Fixed chunks of batches: the same whatever the number of threads.
inline int Problem::Inside::chunks() const {
  return std::clamp(data.batches() / 4, 1, size() > 200 ? 8 : 32);
}

template <class F>  // f(bench, chunk, batch)
void Problem::Inside::each_batch(std::span<const double> x, F f) {
  const int count = chunks();
  const std::vector<double> values = slots(x);
  const int threads = data.batches() < 32 ? 1 : options.threads;
  for (int t = 0; t < std::max(1, threads); ++t) plan.set_parameters(benches[t].workspace, values);
  parallel_chunks(count, threads, [&](int chunk, int worker) {
    const int first = static_cast<int>(static_cast<long>(data.batches()) * chunk / count);
    const int last = static_cast<int>(static_cast<long>(data.batches()) * (chunk + 1) / count);
    for (int b = first; b < last; ++b) {
      load_state(benches[worker], b, x);
      f(benches[worker], chunk, b);
    }
  });
}

}  // namespace talus
