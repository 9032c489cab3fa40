#include "framework/metrology/datum.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace talus {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

// a x (columns of B)
Matrix3Xd across(const Vector3d& a, const Matrix3Xd& B) {
  Matrix3Xd result(3, B.cols());
  for (Eigen::Index i = 0; i < B.cols(); ++i) result.col(i) = a.cross(Vector3d(B.col(i)));
  return result;
}

// a times each number of a row
Matrix3Xd outer(const Vector3d& a, const Eigen::RowVectorXd& row) {
  Matrix3Xd result(3, row.cols());
  for (Eigen::Index i = 0; i < row.cols(); ++i) result.col(i) = a * row[i];
  return result;
}

// The point nearest to points, lines and planes: (sum P_i) o = sum P_i c_i, P_i projecting on where
// shape i holds its origin. What moves an axis moves its P_i: P = I - d d^T or d d^T.
Derived nearest_point(const std::vector<const FittedShape*>& shapes, const Datum& datum) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const FittedShape* s : shapes) sum += s->held, right += s->held * s->origin.value;
  if (!(sum.determinant() > 1e-6))
    throw InputError(
        datum.place,
        fmt::format("the shapes named for the origin of datum '{}' do not fix a point", datum.name),
        "a circle or sphere, an axis and a plane across it, or three planes");
  const Eigen::Matrix3d inverse = sum.inverse();
  Derived o{inverse * right, Matrix3Xd::Zero(3, shapes[0]->origin.by.cols())};
  for (const FittedShape* s : shapes) {
    o.by += s->held * s->origin.by;
    const Vector3d away = s->origin.value - o.value;
    const double sign = s->held.trace() > 2.5 ? 0 : s->held.trace() > 1.5 ? -1 : 1;
    if (sign != 0)  // dP (c - o), P = +-d d^T
      o.by += sign * (s->axis.by * s->axis.value.dot(away) +
                      outer(s->axis.value, away.transpose() * s->axis.by));
  }
  o.by = (inverse * o.by).eval();
  return o;
}

Derived direction(const Datum::Axis& axis, const std::vector<FittedShape>& shapes) {
  Derived d = shapes[axis.shape].axis;
  if (axis.reversed) d.value *= -1, d.by *= -1;
  return d;
}

}  // namespace

DerivedFrame frame_of(const Datum& datum, const std::vector<FittedShape>& shapes, double& square) {
  DerivedFrame frame;
  std::vector<const FittedShape*> on;
  for (int s : datum.origin) on.push_back(&shapes[s]);
  frame.origin = nearest_point(on, datum);

  const Derived a = direction(datum.axes[0], shapes);
  const bool two = datum.axes.size() > 1;
  const int i = datum.axes[0].axis, j = two ? datum.axes[1].axis : (i + 1) % 3, k = 3 - i - j;
  const double hand = (j - i + 3) % 3 == 1 ? 1 : -1;
  // The second axis at right angles to the first; without a shape for it, any.
  Derived b{a.value.unitOrthogonal(), {}};
  if (two) {
    const Derived raw = direction(datum.axes[1], shapes);
    const double along = a.value.dot(raw.value);
    b.value = raw.value - along * a.value;
    const double length = b.value.norm();
    if (!(length > 0.1))
      throw InputError(datum.place,
                       fmt::format("two axes of datum '{}' follow shapes that are {:.2g} deg from "
                                   "parallel",
                                   datum.name, std::asin(std::min(1.0, length)) / deg),
                       "shapes whose axes are about at right angles");
    const Eigen::RowVectorXd dalong = a.value.transpose() * raw.by + raw.value.transpose() * a.by;
    b.by = (raw.by - outer(a.value, dalong) - along * a.by) / length;
    b.value /= length;
    b.by -= outer(b.value, b.value.transpose() * b.by);  // of the unit vector
  } else {
    b.by = -outer(a.value, b.value.transpose() * a.by);
  }
  const Derived c{hand * a.value.cross(b.value),
                  hand * (across(a.value, b.by) - across(b.value, a.by))};
  frame.R.col(i) = a.value, frame.R.col(j) = b.value, frame.R.col(k) = c.value;
  frame.turn = 0.5 * (across(a.value, a.by) + across(b.value, b.by) + across(c.value, c.by));

  square = 0;
  for (std::size_t p = 0; p < datum.axes.size(); ++p)
    for (std::size_t q = p + 1; q < datum.axes.size(); ++q)
      square = std::max(square,
                        std::abs(std::asin(std::clamp(shapes[datum.axes[p].shape].axis.value.dot(
                                                          shapes[datum.axes[q].shape].axis.value),
                                                      -1.0, 1.0))));
  return frame;
}

DerivedFrame seen_from(const DerivedFrame& in, const DerivedFrame& frame) {
  DerivedFrame result;
  const Vector3d v = frame.origin.value - in.origin.value;
  result.origin.value = in.R.transpose() * v;
  result.origin.by = in.R.transpose() * (frame.origin.by - in.origin.by + across(v, in.turn));
  result.R = in.R.transpose() * frame.R;
  result.turn = in.R.transpose() * (frame.turn - in.turn);
  return result;
}

DerivedColumns columns_of(const Feature& feature, const DerivedFrame& frame) {
  const Vector3d& p = frame.origin.value;
  DerivedColumns out;
  auto take = [&](const Vector3d& v, const Matrix3Xd& by) {
    out.values.assign(v.data(), v.data() + 3);
    out.by = by;
  };
  switch (feature.kind) {
    case Kind::frame: {
      Eigen::Quaterniond q(frame.R);
      if (q.w() < 0) q.coeffs() *= -1;
      out.values = {p[0], p[1], p[2], q.w(), q.x(), q.y(), q.z()};
      out.by.resize(7, p.size() ? frame.origin.by.cols() : 0);
      out.by.topRows<3>() = frame.origin.by;
      for (Eigen::Index i = 0; i < out.by.cols(); ++i) {  // dq = 1/2 (0, turn) q
        const Vector3d t = frame.turn.col(i);
        const Eigen::Quaterniond d = Eigen::Quaterniond(0, t[0] / 2, t[1] / 2, t[2] / 2) * q;
        out.by.col(i).tail<4>() << d.w(), d.x(), d.y(), d.z();
      }
      break;
    }
    case Kind::point:
      take(p, frame.origin.by);
      break;
    case Kind::direction: {
      const Vector3d u = frame.R.col(2);
      const Matrix3Xd du = -across(u, frame.turn);
      take(u, du);
      if (feature.observed.angles)
        for (int i = 0; i < 3; ++i) {
          out.values[i] = std::acos(std::clamp(u[i], -1.0, 1.0));
          out.by.row(i) = -du.row(i) / std::max(1e-12, std::sqrt(1 - u[i] * u[i]));
        }
      break;
    }
    case Kind::scalar:
      out.values = {p.norm()};
      out.by = p.transpose() / p.norm() * frame.origin.by;
      break;
    case Kind::nothing:
      break;
  }
  return out;
}

DerivedColumns columns_of(const Feature& feature, const FittedShape& shape,
                          const DerivedFrame* in) {
  // A frame at the shape's origin with its axis as z; how it turns about z is of no matter.
  DerivedFrame frame;
  frame.origin = shape.origin;
  const Vector3d& z = shape.axis.value;
  if (z.norm() > 0.5) {
    frame.R.col(2) = z;
    frame.R.col(0) = z.unitOrthogonal();
    frame.R.col(1) = z.cross(Vector3d(frame.R.col(0)));
  }
  frame.turn = across(z, shape.axis.by);
  return columns_of(feature, in ? seen_from(*in, frame) : frame);
}

}  // namespace talus
