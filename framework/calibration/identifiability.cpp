#include "framework/calibration/identifiability.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {

double typical_size(const Quantity& quantity, Dimension dimension) {
  if (quantity.tolerance) return *quantity.tolerance;
  if (dimension == length) return 10;
  if (dimension == angle) return 10 * deg;
  return std::max(0.1, 0.1 * std::abs(quantity.value));
}

namespace {

// A sparse basis of the columns' span: reduced row echelon form with complete pivoting, so that
// each direction has its own leading parameter and as few others as possible.
Eigen::MatrixXd sparse_basis(Eigen::MatrixXd V) {
  const auto k = V.cols();
  std::vector<Eigen::Index> pivots;
  for (Eigen::Index c = 0; c < k; ++c) {
    Eigen::Index row = 0, column = 0;
    Eigen::MatrixXd rest = V.rightCols(k - c).cwiseAbs();
    for (auto p : pivots) rest.row(p).setZero();
    double best = 0;
    for (Eigen::Index i = 0; i < rest.rows(); ++i)  // the first of equals, whatever the rounding
      for (Eigen::Index j = 0; j < rest.cols(); ++j)
        if (rest(i, j) > 1.001 * best) best = rest(i, j), row = i, column = j;
    V.col(c).swap(V.col(c + column));
    V.col(c) /= V(row, c);
    for (Eigen::Index other = 0; other < k; ++other)
      if (other != c) V.col(other) -= V(row, other) * V.col(c);
    pivots.push_back(row);
  }
  return V;
}

// `move`: a direction, in internal units.
std::string sentence(const Eigen::VectorXd& move, const std::vector<std::string>& names,
                     const Problem& problem, const UnitSystem& units) {
  Eigen::VectorXd scaled(move.size());
  for (int i = 0; i < move.size(); ++i)
    scaled[i] = std::abs(move[i]) / typical_size(problem.quantity(i), problem.dimension(i));
  std::vector<int> order;
  const double largest = scaled.maxCoeff();  // equals, but for rounding, stay in the model's order
  for (int i = 0; i < scaled.size(); ++i)
    if (scaled[i] > 0.02 * largest) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return std::round(500 * scaled[a] / largest) > std::round(500 * scaled[b] / largest);
  });
  auto unit = [&](int i) { return units.of(problem.dimension(i)); };
  const int lead = order[0];
  const auto& tolerance = problem.quantity(lead).tolerance;
  if (order.size() == 1)
    return tolerance
               ? fmt::format(
                     "{} is not seen by these recordings; it keeps its tolerance of {:.3g} {}",
                     names[lead], *tolerance / unit(lead).factor, unit(lead).text)
               : fmt::format("{} is not seen by these recordings", names[lead]);
  const double unit_move =
      unit(lead).factor / move[lead];  // for a unit move of the leading parameter
  std::string others;
  const std::size_t shown = std::min<std::size_t>(order.size(), 7);
  for (std::size_t k = 1; k < shown; ++k) {
    const int i = order[k];
    const char* join = k == 1 ? "" : k + 1 == shown && shown == order.size() ? " and " : ", ";
    others += fmt::format("{}{} by {:+.3g} {}", join, names[i],
                          move[i] * unit_move / unit(i).factor, unit(i).text);
  }
  if (shown < order.size())
    others += fmt::format(" and {} more by smaller amounts", order.size() - shown);
  return fmt::format(
      "only a combination with {} is seen: moving it by +1 {} together with {} changes no residual "
      "noticeably",
      names[lead], unit(lead).text, others);
}

}  // namespace

Identifiability identify(Problem& problem, std::span<const double> x, double noise_scale,
                         const UnitSystem& units) {
  Identifiability result;
  const int all = problem.size();
  result.std.setConstant(all, std::numeric_limits<double>::infinity());
  result.identifiable.assign(all, false);
  std::vector<int> own;  // entries of x that these rows have to do with
  for (int i = 0; i < all; ++i)
    if (problem.occurs(i)) own.push_back(i);
  const int n = static_cast<int>(own.size());
  if (n == 0) return result;
  Eigen::VectorXd size(n);
  Eigen::MatrixXd J(all, n);
  const Eigen::MatrixXd factor = problem.information(x).factor;
  for (int i = 0; i < n; ++i) {
    size[i] = typical_size(problem.quantity(own[i]), problem.dimension(own[i]));
    J.col(i) = factor.col(own[i]).head(all) * size[i] / noise_scale;
  }
  if (!J.allFinite()) return result;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeFullV);
  result.singular = svd.singularValues();
  for (int i = 0; i < n; ++i) result.seen += result.singular[i] >= 1;
  const Eigen::MatrixXd unseen = svd.matrixV().rightCols(n - result.seen);

  // Uncertainty with priors, scaled to a unit diagonal so that no tolerance, however wide, drowns
  // the others.
  Eigen::MatrixXd H = J.transpose() * J;
  for (int i = 0; i < n; ++i)
    if (problem.quantity(own[i]).tolerance) H(i, i) += 1;
  Eigen::VectorXd unit(n);
  for (int i = 0; i < n; ++i) unit[i] = H(i, i) > 0 ? 1 / std::sqrt(H(i, i)) : 0;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(unit.asDiagonal() * H *
                                                             unit.asDiagonal());
  const double floor = 1e-14 * n;
  for (int i = 0; i < n; ++i) {
    double variance = unit[i] > 0 ? 0 : std::numeric_limits<double>::infinity();
    double seen_part = 0;
    for (int k = 0; k < n; ++k) {
      const double value = eigen.eigenvalues()[k],
                   part = eigen.eigenvectors()(i, k) * eigen.eigenvectors()(i, k);
      if (value > floor)
        variance += part / value * unit[i] * unit[i], seen_part += part;
      else if (part > 1e-6)
        variance = std::numeric_limits<double>::infinity();
    }
    result.effective += problem.quantity(own[i]).tolerance
                            ? (std::isfinite(variance) ? 1 - variance : 0)
                            : seen_part;
    result.std[own[i]] = std::sqrt(variance) * size[i];
    result.identifiable[own[i]] = unseen.row(i).squaredNorm() < 0.01;
  }

  if (unseen.cols() > 0) {
    const Eigen::MatrixXd basis = sparse_basis(unseen);
    result.directions.setZero(all, basis.cols());
    for (int i = 0; i < n; ++i) result.directions.row(own[i]) = size[i] * basis.row(i);
    const std::vector<std::string> names = problem.names();
    for (Eigen::Index c = 0; c < basis.cols(); ++c)
      result.unseen.push_back(sentence(result.directions.col(c), names, problem, units));
  }
  if (result.seen > 0) {
    const Eigen::VectorXd s = result.singular.head(result.seen);
    const double m =
        std::sqrt(static_cast<double>(std::max<std::size_t>(1, problem.data().used())));
    result.o1 = std::exp(s.array().log().mean()) / m;
    result.o2 = s[result.seen - 1] / s[0];
    result.o3 = s[result.seen - 1];
    result.o4 = s[result.seen - 1] * s[result.seen - 1] / s[0];
    result.o5 = 1 / s.array().inverse().sum();
  }
  return result;
}

}  // namespace talus
