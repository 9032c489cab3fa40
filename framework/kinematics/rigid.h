// Rigid transforms. T_A_B maps coordinates given in frame B to frame A: p_A = T_A_B * p_B.
//
// A transform is a product of elementary motions (rotations about and translations along the
// coordinate axes, and rotations given by a matrix). It is kept as that product as long as nobody
// looks at its entries: the solver needs each motion's own axis, not the matrix. Since only proper
// motions can be made, every product is a proper rigid transform.
//
//     Rigid<T> T_A_B = rotate_z(theta) * translate_z(d) * translate_x(a) * rotate_x(alpha);
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "framework/kinematics/expr.h"

namespace talus {

template <class T>
using Vector3 = std::array<T, 3>;

template <class T>
using Matrix3 = std::array<std::array<T, 3>, 3>;  // [row][column]

template <class T>
struct Motion {
  enum class Kind { rotation, translation, matrix };
  Kind kind = Kind::translation;
  int axis = 0;              // 0, 1, 2: x, y, z of the frame before the motion
  T amount{};                // rad or mm; for rotation and translation
  Matrix3<T> rotation{};     // for matrix
  Vector3<T> translation{};  // for matrix
};

template <class T>
class Rigid {
 public:
  Rigid() = default;  // identity
  explicit Rigid(Motion<T> motion) : motions_{std::move(motion)} {}
  // `rotation` must be orthonormal with determinant 1; use the functions below, which see to it.
  Rigid(const Matrix3<T>& rotation, const Vector3<T>& translation)
      : motions_{{Motion<T>::Kind::matrix, 0, T{}, rotation, translation}} {}

  const std::vector<Motion<T>>& motions() const { return motions_; }
  Matrix3<T> rotation() const { return collapse().rotation; }
  Vector3<T> translation() const { return collapse().translation; }
  T rotation(int row, int column) const { return rotation()[row][column]; }
  T translation(int row) const { return translation()[row]; }
  Vector3<T> operator*(const Vector3<T>& p_B) const;  // p_A

  friend Rigid operator*(Rigid a, const Rigid& b) {
    a.motions_.insert(a.motions_.end(), b.motions_.begin(), b.motions_.end());
    return a;
  }

 private:
  Motion<T> collapse() const;
  std::vector<Motion<T>> motions_;
};

template <class T>
Rigid<T> rotate_x(const T& angle) {
  return Rigid<T>({Motion<T>::Kind::rotation, 0, angle});
}
template <class T>
Rigid<T> rotate_y(const T& angle) {
  return Rigid<T>({Motion<T>::Kind::rotation, 1, angle});
}
template <class T>
Rigid<T> rotate_z(const T& angle) {
  return Rigid<T>({Motion<T>::Kind::rotation, 2, angle});
}
template <class T>
Rigid<T> translate_x(const T& by) {
  return Rigid<T>({Motion<T>::Kind::translation, 0, by});
}
template <class T>
Rigid<T> translate_y(const T& by) {
  return Rigid<T>({Motion<T>::Kind::translation, 1, by});
}
template <class T>
Rigid<T> translate_z(const T& by) {
  return Rigid<T>({Motion<T>::Kind::translation, 2, by});
}
template <class T>
Rigid<T> translate(const T& x, const T& y, const T& z) {
  return translate_x(x) * translate_y(y) * translate_z(z);
}

template <class T>
Rigid<T> inverse(const Rigid<T>& t) {
  Rigid<T> result;
  for (auto m = t.motions().rbegin(); m != t.motions().rend(); ++m) {
    Motion<T> back = *m;
    back.amount = -m->amount;
    if (m->kind == Motion<T>::Kind::matrix)
      for (int i = 0; i < 3; ++i) {
        back.translation[i] = T{};
        for (int j = 0; j < 3; ++j) {
          back.rotation[i][j] = m->rotation[j][i];
          back.translation[i] = back.translation[i] - m->rotation[j][i] * m->translation[j];
        }
      }
    result = result * Rigid<T>(back);
  }
  return result;
}

// Rotation by `angle` about the unit vector (ux, uy, uz) through the origin (Rodrigues).
template <class T>
Rigid<T> rotate_about_unit(const Vector3<T>& u, const T& angle) {
  using std::cos, std::sin;
  const T c = cos(angle), s = sin(angle), v = T(1) - c;
  return Rigid<T>({{{c + u[0] * u[0] * v, u[0] * u[1] * v - u[2] * s, u[0] * u[2] * v + u[1] * s},
                    {u[0] * u[1] * v + u[2] * s, c + u[1] * u[1] * v, u[1] * u[2] * v - u[0] * s},
                    {u[0] * u[2] * v - u[1] * s, u[1] * u[2] * v + u[0] * s, c + u[2] * u[2] * v}}},
                  {});
}

// The same for an axis of any length but zero.
template <class T>
Rigid<T> rotate_about(const T& x, const T& y, const T& z, const T& angle) {
  using std::sqrt;
  const T norm = sqrt(x * x + y * y + z * z);
  return rotate_about_unit<T>({x / norm, y / norm, z / norm}, angle);
}

// Rotation of a quaternion of any length but zero (either sign), then placed at (x, y, z).
template <class T>
Rigid<T> from_quaternion(const Vector3<T>& p, const T& w, const T& x, const T& y, const T& z) {
  const T s = T(2) / (w * w + x * x + y * y + z * z);
  return Rigid<T>({{{T(1) - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
                    {s * (x * y + w * z), T(1) - s * (x * x + z * z), s * (y * z - w * x)},
                    {s * (x * z - w * y), s * (y * z + w * x), T(1) - s * (x * x + y * y)}}},
                  p);
}

// Rotation vector (axis times angle, rad); smooth through zero.
template <class T>
Rigid<T> rotate_by_vector(const T& x, const T& y, const T& z);

// Its inverse, for angles below 180 deg; smooth through zero. (Logarithm of a rotation matrix.)
template <class T>
Vector3<T> rotation_vector(const Matrix3<T>& rotation);

// Three angles in the usual orders: Rz(a) Rx(b) Rz(c), and Rz(yaw) Ry(pitch) Rx(roll).
template <class T>
Rigid<T> rotate_zxz(const T& a, const T& b, const T& c) {
  return rotate_z(a) * rotate_x(b) * rotate_z(c);
}
template <class T>
Rigid<T> rotate_rpy(const T& roll, const T& pitch, const T& yaw) {
  return rotate_z(yaw) * rotate_y(pitch) * rotate_x(roll);
}

// Small helpers on vectors and rotation matrices.
template <class T>
T dot(const Vector3<T>& a, const Vector3<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
Vector3<T> cross(const Vector3<T>& a, const Vector3<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T>
Vector3<T> operator-(const Vector3<T>& a, const Vector3<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
Vector3<T> column(const Matrix3<T>& R, int j) {
  return {R[0][j], R[1][j], R[2][j]};
}

// sqrt(q) whose derivative at 0 is 0 instead of infinite: for lengths that may vanish.
template <class T>
T safe_sqrt(const T& q) {
  using std::sqrt;
  const T positive = less(T(0), q);
  return select(positive, sqrt(select(positive, q, T(1))), T(0));
}
template <class T>
T norm(const Vector3<T>& a) {
  return safe_sqrt(dot(a, a));
}

// A vector given in A, seen from B: R_A_B^T v_A; and the rotation R_B_C = R_A_B^T R_A_C.
template <class T>
Vector3<T> seen_from(const Matrix3<T>& R_A_B, const Vector3<T>& v_A) {
  return {dot(column(R_A_B, 0), v_A), dot(column(R_A_B, 1), v_A), dot(column(R_A_B, 2), v_A)};
}
template <class T>
Matrix3<T> seen_from(const Matrix3<T>& R_A_B, const Matrix3<T>& R_A_C) {
  Matrix3<T> R_B_C;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) R_B_C[i][j] = dot(column(R_A_B, i), column(R_A_C, j));
  return R_B_C;
}

}  // namespace talus

#include "framework/kinematics/rigid_inl.h"
