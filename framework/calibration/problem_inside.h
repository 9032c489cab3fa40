// The inside of a calibration problem, shared by problem.cpp and batch.cpp.
#pragma once

#include "framework/calibration/problem.h"

namespace talus {

// What one thread works with.
struct Bench {
  Buffer workspace;
  Buffer state;      // [state slot][lane]
  Buffer whitened;   // [row][lane]
  Buffer transform;  // [row][row][lane]
  Buffer columns;    // of latent unknowns or readings: [column][row][lane]
  Buffer panel;      // [column][batches of the panel][row][lane]
  double rho[lanes], rho1[lanes], alpha[lanes], squares[lanes];
};

struct Problem::Inside {
  // Column sets of the plan.
  enum Set { kGlobal = 0, kLatent = 1, kReadings = 2 };

  const Program& program;
  ProblemOptions options;
  Groups groups;
  std::vector<int> latent_slots, shared_slots, noisy_slots;
  std::vector<double> noise_variance;  // of noisy_slots
  Plan plan;
  Dataset data;
  std::vector<double> start;
  std::vector<bool> occurs;  // of each entry of x
  std::vector<Quantity> quantities;
  std::vector<Dimension> dimensions;
  std::vector<int> offset;            // of each shared unknown's instances in x
  std::vector<Quantity> latent_prior;
  bool robust = true, qr = false, dense = false;
  double noise_variance_of_rows = 1;
  Buffer weights;                     // per batch: [row][lane], or [row][row][lane] where dense
  Buffer latent;                      // per batch: [latent][lane], the last solution
  Buffer latent_trial;
  std::vector<Bench> benches;
  std::vector<double> row_factor;     // 1/sigma or the papers' weight, per row

  Inside(const Program& program, Plan plan, const Recordings& recordings, const std::vector<std::size_t>& rows, const Groups& groups,
         const ProblemOptions& options);

  int rows() const { return plan.rows(); }
  int size() const { return static_cast<int>(quantities.size()); }
  int parameters() const { return options.only_unknowns ? 0 : static_cast<int>(program.parameters.size()); }
  std::vector<double> slots(std::span<const double> x) const;  // values at the parameters' slots
  std::vector<double> held;  // parameters' values where they are held

  std::size_t weight_block() const { return static_cast<std::size_t>(rows()) * (dense ? rows() : 1) * lanes; }
  RowTransform whitening(int b) const;

  void fill_weights();

  // batch.cpp
  void load_state(Bench& bench, int b, std::span<const double> x) const;
  void evaluate(Bench& bench, int b);                   // rows, whitened rows, squares; latent unknowns solved
  void whiten(Bench& bench, int b);
  void solve_latent(Bench& bench, int b);
  void combined_covariance(Bench& bench, int b);
  void losses(Bench& bench, int b, bool robust);        // rho, rho', alpha of the squares
  RowTransform transform(Bench& bench, int b, bool robust);  // whitening, projection, robust correction
  double batch_cost(const Bench& bench, int b) const;

  Normal normal(std::span<const double> x, bool robust, bool priors);
  template <class F> void each_batch(std::span<const double> x, F f);
};

}  // namespace talus
