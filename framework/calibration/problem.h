// A calibration problem: a program and the recorded rows to be explained, as a function of the free
// parameters x (the program's parameters, then the instances of the group unknowns).
//
// Per pose k the rows r_k are whitened by W_k (stated sigmas, or the full covariance with the
// readings' noise carried through the chain, or the papers' weights), unknowns of the pose are
// solved for and projected out (variable projection), and a loss rho acts on s_k = |W_k r_k|^2. All
// three are one small matrix A_k applied to the rows before the columns are formed, so they cost
// next to nothing:
//     cost(x) = 1/2 sum_k rho(s_k) + 1/2 sum_i ((x_i - nominal_i) / tolerance_i)^2.
// What comes back is the normal form: H = J^T J, g = J^T r, cost; as a factor (see Normal).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "framework/calibration/dataset.h"

namespace talus {

struct ProblemOptions {
  int threads = 1;
  bool propagate = true;  // carry the readings' noise into each pose's covariance
  bool priors = true;     // tolerances act as Gaussian priors
  bool robust = true;     // the settings' loss and objective; otherwise plain least squares
  bool only_unknowns =
      false;  // parameters are held; only group unknowns (and latent ones) are free
};

// J and r reduced to as many rows as columns: factor^T factor = [J r]^T [J r] with columns J, then
// r; the last diagonal entry is such that |r|^2 is twice the cost.
struct Normal {
  Eigen::MatrixXd factor;  // (n+1) x (n+1)
  double cost = 0;
};

// The plan a problem needs. It depends on the model alone, so it may be made once for many
// problems.
Plan plan_for(const Program& program, const Groups& groups, const ProblemOptions& options);

class Problem {
 public:
  Problem(const Program& program, const Plan& plan, const Recordings& recordings,
          const std::vector<std::size_t>& rows, const Groups& groups,
          const ProblemOptions& options);
  Problem(const Program& program, const Recordings& recordings,
          const std::vector<std::size_t>& rows, const Groups& groups,
          const ProblemOptions& options);
  ~Problem();
  Problem(Problem&&) noexcept;

  int size() const;
  const std::vector<double>& start() const;  // nominal values
  std::vector<std::string> names() const;    // of x
  // Of entry i of x: prior mean and standard deviation, bounds.
  const Quantity& quantity(int i) const;
  Dimension dimension(int i) const;
  bool occurs(int i) const;  // false for an instance of a group unknown that has no row here

  void set_robust(bool on);
  // The latent unknowns' values belong to a solution as x does: they are where the next evaluation
  // starts from.
  Buffer latent_values() const;
  void set_latent_values(const Buffer& values);
  void reset_latent_values();  // back to their start
  // Tries further starts of each pose's unknowns at x and keeps what fits better.
  void scatter_latents(std::span<const double> x, std::uint64_t seed);
  double latent_freedom(
      std::span<const double> x);  // rows' worth of freedom that the latent unknowns take
  double noise_variance() const;
  // Where the noise is not stated, priors weigh in units of the estimated one: the variance of a
  // weighted row.
  void set_noise_variance(double variance);
  // The published objective squares each pose's sum of squares s, so its rows pull 2 s times as
  // hard, and so must the tolerances: by the mean of 2 s at the least-squares solution.
  void set_mean_slope(double slope);
  void set_qr(bool on);  // accumulate by QR instead of Gram matrices
  bool qr() const;
  void hold(const std::vector<double>& parameters);  // their values where only unknowns are free
  // Recomputes the whitening at x (it depends on the parameters through the readings' noise).
  void set_weights(std::span<const double> x);
  bool whitening_depends_on_parameters() const;
  // Rows whose noise follows from that of others of their pose, so that they tell nothing new.
  std::size_t dependent_rows() const;
  void divide_rows_by(
      const std::vector<double>& scale);  // full-scale ranges; before anything is solved

  double cost(std::span<const double> x);
  Normal normal(std::span<const double> x);
  // The same without priors and robust loss: what the recordings alone say.
  Normal information(std::span<const double> x);

  // Rows at x, unweighted, [recorded row][residual row]; NaN where a value is missing. Whitened
  // ones likewise.
  struct Residuals {
    std::vector<std::size_t> poses;  // recorded rows
    Eigen::MatrixXd raw, whitened;   // poses x rows
    Eigen::MatrixXd latent;          // poses x latent unknowns
  };
  Residuals residuals(std::span<const double> x);

  // What each pose says on its own (problem_poses.cpp), poses in the order of `rows`; not for
  // unknowns shared by groups of rows. Latent unknowns start from the given values, poses x latent.
  void set_latents(const Eigen::MatrixXd& values);
  // Row k: the gradient by x of half the sum of squares of pose k; latent unknowns projected out.
  Eigen::MatrixXd scores(std::span<const double> x);
  // The problem made linear at x: whitened rows r and their columns J, r(x + dx) = r + J dx; latent
  // unknowns are projected out, so a row of unit variance is left with as much as they do not take.
  // Rows of one pose stand together, poses in the order of Residuals::poses. Entry j of the columns
  // belongs to entry j of x; without priors.
  struct Linear {
    Eigen::VectorXd rows;
    Eigen::MatrixXd columns;
    std::vector<int> pose;  // of each row: number of its pose
  };
  Linear linear(std::span<const double> x);
  // Where the noise of the rows of linear(x) comes from: what each source (a reading, a measured
  // row, a feature whose rows are carried from its columns) contributes to their covariance, pose
  // by pose in that order. The shares add up to the unit matrix, less what latent unknowns, missing
  // and dependent rows take. Only where the noise is known (problem_noise.cpp).
  struct NoiseSource {
    std::string name;  // the sensor, the row's measure, the feature
    int feature = -1;  // -1: a reading
    Dimension dimension;
    double sigma = 0;  // as stated; zero where it is carried
  };
  struct Noise {
    std::vector<NoiseSource> sources;
    std::vector<std::vector<Eigen::MatrixXd>> shares;  // [pose][source], rows x rows
    // [pose], rows x sources: what one sigma of the source does to the rows, whose square its share
    // is; zero of carried ones.
    std::vector<Eigen::MatrixXd> columns;
  };
  Noise noise(std::span<const double> x);
  // Per pose: J^T J of the whitened rows by the latent unknowns.
  std::vector<Eigen::MatrixXd> latent_information(std::span<const double> x);

  const Dataset& data() const;
  const Groups& groups() const;
  int rows() const;
  int latents() const;
  bool noise_known() const;  // every row has a stated standard deviation

 private:
  struct Inside;
  std::unique_ptr<Inside> in_;
};

}  // namespace talus
