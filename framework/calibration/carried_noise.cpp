#include "framework/calibration/carried_noise.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace talus {
namespace {

Eigen::MatrixXd across(const Eigen::VectorXd& v, double variance) {
  return variance *
         (v.squaredNorm() * Eigen::MatrixXd::Identity(v.size(), v.size()) - v * v.transpose());
}

Eigen::MatrixXd covariance(const Feature& f, const Eigen::VectorXd& shown) {
  const double length = f.sigma_length.value_or(0), angle = f.sigma_angle.value_or(0);
  if (f.kind == Kind::direction) return across(shown, angle * angle);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(7, 7);
  C.topLeftCorner<3, 3>().diagonal().setConstant(length * length);
  C.bottomRightCorner<4, 4>() = across(shown.tail<4>(), angle * angle / 4);
  return C;
}

}  // namespace

MeasuredNoise carried_noise(const Program& program, const Recordings& recordings) {
  MeasuredNoise noise;
  const MeasuredNoise& points = recordings.noise;
  std::vector<const Feature*> carried;
  const auto from_points = [&](const std::string& column) {
    return std::find(points.columns.begin(), points.columns.end(), column) != points.columns.end();
  };
  for (const Feature& f : program.features)
    if (f.carried && !from_points(program.columns[f.columns[0]].name)) carried.push_back(&f);
  if (carried.empty()) return noise;
  std::vector<const RecordedColumn*> columns;
  for (const Feature* f : carried)
    for (int c : f->columns) {
      noise.columns.push_back(program.columns[c].name);
      columns.push_back(&recordings.get(program.columns[c].name, program.columns[c].dimension));
    }
  noise.columns.insert(noise.columns.end(), points.columns.begin(), points.columns.end());
  const auto n = static_cast<Eigen::Index>(noise.columns.size()),
             of_points = static_cast<Eigen::Index>(points.columns.size());
  for (std::size_t k = 0; k < recordings.rows(); ++k) {
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(n, n);
    Eigen::Index next = 0;
    for (const Feature* f : carried) {
      const auto count = static_cast<Eigen::Index>(f->columns.size());
      Eigen::VectorXd shown(count);
      for (Eigen::Index i = 0; i < count; ++i) shown[i] = columns[next + i]->values[k];
      if (shown.allFinite()) whole.block(next, next, count, count) = covariance(*f, shown);
      next += count;
    }
    if (of_points > 0 && !points.covariance[k].empty())
      whole.bottomRightCorner(of_points, of_points) =
          Eigen::Map<const Eigen::MatrixXd>(points.covariance[k].data(), of_points, of_points);
    noise.covariance.emplace_back(whole.data(), whole.data() + whole.size());
  }
  return noise;
}

}  // namespace talus
