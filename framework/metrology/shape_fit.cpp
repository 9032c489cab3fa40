#include "framework/metrology/shape_fit.h"

#include <ceres/tiny_solver.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>
#include <limits>

namespace talus {
namespace {

using Eigen::Vector3d;

constexpr int kUnknowns = 6;  // shifts x, y, z, turns about x and y, radius
constexpr int kStride = 1 + kUnknowns + 3;

struct Start {
  Vector3d origin, axis;
};

Eigen::Matrix3d any_frame_along(const Vector3d& z) {
  Eigen::Matrix3d R;
  R.col(2) = z.normalized();
  R.col(0) = R.col(2).unitOrthogonal();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

}  // namespace

ShapeFitter::ShapeFitter(const ProbedShape& shape) : shape_(shape) {
  std::array<Expr, kUnknowns + 3> s;
  for (int i = 0; i < kUnknowns + 3; ++i) s[i] = Expr::leaf(tape_, i);
  const Vector3<Expr> p{s[6] - s[0], s[7] - s[1], s[8] - s[2]};
  const Rigid<Expr> turned = rotate_y(-s[4]) * rotate_x(-s[3]);
  std::vector<std::int32_t> nodes;
  for (const Expr& deviation : shape.deviations(turned * p, s[5])) {
    const auto by = gradient(deviation);
    has_radius_ = has_radius_ || by.contains(5);
    nodes.push_back(deviation.node_on(tape_));
    for (int i = 0; i < kUnknowns + 3; ++i)
      nodes.push_back((by.contains(i) ? by.at(i) : Expr(0)).node_on(tape_));
    ++per_point_;
  }
  values_ = TapeValues(tape_, std::move(nodes));
}

// The deviations as ceres' small solver wants them: points in the frame that the fit starts from.
struct ShapeFitter::Cost {
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = kUnknowns };
  const ShapeFitter& fitter;
  std::vector<Vector3d> points;
  bool radius_known;

  int NumResiduals() const { return static_cast<int>(points.size()) * fitter.per_point_; }
  const std::vector<double>& at(const double* q, const Vector3d& p) const {
    const double slots[] = {q[0], q[1], q[2], q[3], q[4], q[5], p[0], p[1], p[2]};
    return fitter.values_(slots);
  }
  bool operator()(const double* q, double* residuals, double* jacobian) const {
    const int n = NumResiduals();
    int row = 0;
    for (const Vector3d& p : points) {
      const auto& v = at(q, p);
      for (int d = 0; d < fitter.per_point_; ++d, ++row) {
        residuals[row] = v[d * kStride];
        if (!std::isfinite(residuals[row])) return false;
        if (!jacobian) continue;
        for (int i = 0; i < kUnknowns; ++i)
          jacobian[i * n + row] = i == 5 && radius_known ? 0 : v[d * kStride + 1 + i];
      }
    }
    return true;
  }
};

FittedShape ShapeFitter::fit(const std::vector<Derived>& points) const {
  FittedShape result;
  const int n = static_cast<int>(points.size());
  result.points = n;
  Vector3d middle = Vector3d::Zero();
  for (const Derived& p : points) middle += p.value / n;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Derived& p : points) spread += (p.value - middle) * (p.value - middle).transpose() / n;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(spread);
  const double size = std::sqrt(spread.trace());

  // From several starts: the axis along each principal direction, the origin in the middle or
  // beside it (points may cover one side only). The first good fit is taken, else the best.
  Vector3d origin = middle;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  double radius = 0, least = std::numeric_limits<double>::infinity();
  const Eigen::Matrix3d E = principal.eigenvectors();
  const std::vector<Vector3d> along{E.col(0),
                                    E.col(2),
                                    E.col(1),
                                    E.col(0) + E.col(1),
                                    E.col(0) - E.col(1),
                                    E.col(1) + E.col(2),
                                    E.col(1) - E.col(2),
                                    E.col(0) + E.col(2),
                                    E.col(0) - E.col(2)};
  std::vector<Start> starts;
  for (const Vector3d& axis : along) starts.push_back({middle, axis});
  for (int i = 0; i < 3; ++i)
    for (double side : {-size, size})
      for (int j = 0; j < 3; ++j) starts.push_back({middle + side * E.col(i), E.col(j)});
  // Where points may fit a shape in two ways, all directions are tried.
  const std::size_t fewest = shape_.radius ? starts.size()
                             : shape_.declaration.sense == Sense::along && per_point_ == 1
                                 ? along.size()
                                 : 1;
  struct Solution {
    double cost;
    Vector3d origin, axis;
  };
  std::vector<Solution> found;
  const double good = std::pow(1e-3 * size, 2) * n;
  for (std::size_t k = 0; k < starts.size() && (k < fewest || least > good); ++k) {
    const Vector3d& from = starts[k].origin;
    const Eigen::Matrix3d frame = any_frame_along(starts[k].axis);
    Cost cost{*this, {}, shape_.radius.has_value()};
    for (const Derived& p : points) cost.points.push_back(frame.transpose() * (p.value - from));
    ceres::TinySolver<Cost> solver;
    solver.options.max_num_iterations = 100;
    solver.options.gradient_tolerance = 1e-14 * size;
    solver.options.parameter_tolerance = 1e-13;
    solver.options.function_tolerance = 1e-15;
    Eigen::Matrix<double, kUnknowns, 1> q = Eigen::Matrix<double, kUnknowns, 1>::Zero();
    q[5] = shape_.radius.value_or(std::hypot(size, (from - middle).norm()));
    const auto& summary = solver.Solve(cost, &q);
    if (!std::isfinite(summary.final_cost) || !q.allFinite()) continue;
    const Eigen::Matrix3d turned = frame * (Eigen::AngleAxisd(q[3], Vector3d::UnitX()) *
                                            Eigen::AngleAxisd(q[4], Vector3d::UnitY()))
                                               .toRotationMatrix();
    found.push_back({summary.final_cost, from + frame * q.head<3>(), turned.col(2)});
    if (!(summary.final_cost < least)) continue;
    least = summary.final_cost;
    origin = from + frame * q.head<3>();
    R = turned;
    radius = q[5];
  }
  // Sense of the axis, from the order of the points.
  double sense = 0;
  if (shape_.declaration.sense == Sense::along)
    sense = R.col(2).dot(points.back().value - points.front().value);
  else if (shape_.declaration.sense == Sense::around)
    for (int i = 0; i < n; ++i)
      sense += R.col(2).dot((points[i].value - middle).cross(points[(i + 1) % n].value - middle));
  if (sense < 0) R.col(2) *= -1, R.col(1) *= -1;
  const double clear = shape_.declaration.sense == Sense::around ? size * size : size;
  result.sense = shape_.declaration.sense == Sense::none
                     ? 1
                     : std::min(1.0, std::abs(sense) / std::max(clear, 1e-300));

  // Derivatives at the solution, in its own frame.
  Cost cost{*this, {}, shape_.radius.has_value()};
  for (const Derived& p : points) cost.points.push_back(R.transpose() * (p.value - origin));
  Eigen::Matrix<double, kUnknowns, 1> q = Eigen::Matrix<double, kUnknowns, 1>::Zero();
  q[5] = radius;
  const int m = cost.NumResiduals();
  Eigen::VectorXd f(m);
  Eigen::MatrixXd J(m, kUnknowns);
  cost(q.data(), f.data(), J.data());
  result.squares = f.squaredNorm();
  Eigen::Matrix<double, kUnknowns, 1> scale = Eigen::Matrix<double, kUnknowns, 1>::Ones();
  scale[3] = scale[4] = 1 / std::max(size, 1e-9);
  const Eigen::MatrixXd scaled = J * scale.asDiagonal();
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition(scaled);
  decomposition.setThreshold(1e-6);
  result.freedom = static_cast<int>(decomposition.rank());
  // A sphere's and a cylinder's radius counts among their freedom where it is not known.
  result.determined =
      result.freedom >= shape_.declaration.freedom - (shape_.radius && has_radius_ ? 1 : 0);
  const Eigen::MatrixXd inverse = scale.asDiagonal() * decomposition.pseudoInverse();
  const Eigen::Index raw = points.empty() ? 0 : points[0].by.cols();
  Eigen::MatrixXd df(m, raw);
  for (int k = 0, row = 0; k < n; ++k) {
    const Eigen::Matrix3Xd local = R.transpose() * points[k].by;
    const auto v = cost.at(q.data(), cost.points[k]);
    for (int d = 0; d < per_point_; ++d, ++row)
      df.row(row) = Eigen::Map<const Eigen::RowVector3d>(&v[d * kStride + 1 + kUnknowns]) * local;
  }
  const Eigen::MatrixXd dq = -inverse * df;
  // What the deviations do when the points move and the fit follows: as many directions as are left
  // to judge it by. (Points that were projected on a plane have none out of it.)
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> left(df + J * dq);
  left.setThreshold(1e-6);
  result.surplus = raw > 0 ? static_cast<int>(left.rank()) : m - result.freedom;
  result.origin = {origin, R * dq.topRows<3>()};
  result.axis = {R.col(2), R.col(0) * dq.row(4) - R.col(1) * dq.row(3)};
  result.radius = radius;
  for (int i = 0; i < 3; ++i)
    if (J.col(i).norm() < 1e-9) result.held -= R.col(i) * R.col(i).transpose();
  // Eight corners of a box lie on three cylinders, a ring of points on two spheres of known radius:
  // which one was meant?
  for (const Solution& other : found)
    if (fewest > 1 && other.cost < 9 * least + 1e-18 * size * size)
      result.ambiguous |=
          (shape_.declaration.sense != Sense::none && other.axis.cross(R.col(2)).norm() > 0.05) ||
          (result.held * (other.origin - origin)).norm() > 0.05 * size;
  return result;
}

std::vector<Derived> projected(const std::vector<Derived>& points, const FittedShape& plane) {
  std::vector<Derived> result;
  const Vector3d& n = plane.axis.value;
  for (const Derived& p : points) {
    const Vector3d away = p.value - plane.origin.value;
    const double height = away.dot(n);
    const Eigen::RowVectorXd dheight =
        n.transpose() * (p.by - plane.origin.by) + away.transpose() * plane.axis.by;
    result.push_back({p.value - height * n, p.by - n * dheight - height * plane.axis.by});
  }
  return result;
}

}  // namespace talus
