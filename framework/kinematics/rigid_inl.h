// Definitions for rigid.h.
#pragma once

namespace talus {

template <class T>
Motion<T> Rigid<T>::collapse() const {
  using std::cos, std::sin;
  Matrix3<T> R{};
  Vector3<T> p{};
  for (int i = 0; i < 3; ++i) R[i][i] = T(1);
  for (const Motion<T>& m : motions_) {
    if (m.kind == Motion<T>::Kind::translation) {
      for (int i = 0; i < 3; ++i) p[i] = p[i] + R[i][m.axis] * m.amount;
    } else if (m.kind == Motion<T>::Kind::rotation) {
      const int u = (m.axis + 1) % 3, v = (m.axis + 2) % 3;
      const T c = cos(m.amount), s = sin(m.amount);
      for (int i = 0; i < 3; ++i) {
        const T ru = R[i][u], rv = R[i][v];
        R[i][u] = ru * c + rv * s;
        R[i][v] = rv * c - ru * s;
      }
    } else {
      const Matrix3<T> before = R;
      for (int i = 0; i < 3; ++i) {
        p[i] = p[i] + dot<T>(before[i], m.translation);
        for (int j = 0; j < 3; ++j)
          R[i][j] = before[i][0] * m.rotation[0][j] + before[i][1] * m.rotation[1][j] +
                    before[i][2] * m.rotation[2][j];
      }
    }
  }
  return {Motion<T>::Kind::matrix, 0, T{}, R, p};
}

template <class T>
Vector3<T> Rigid<T>::operator*(const Vector3<T>& p_B) const {
  const Motion<T> m = collapse();
  Vector3<T> p_A;
  for (int i = 0; i < 3; ++i) p_A[i] = dot<T>(m.rotation[i], p_B) + m.translation[i];
  return p_A;
}

// R = I + a [v] + b [v]^2 with a = sin(t)/t, b = (1 - cos t)/t^2, t = |v|. Below t^2 = 1e-6 the
// Taylor series of a and b are exact to machine precision; `select` keeps both branches finite.
template <class T>
Rigid<T> rotate_by_vector(const T& x, const T& y, const T& z) {
  using std::cos, std::sin, std::sqrt;
  const T q = x * x + y * y + z * z;
  const T small = less(q, T(1e-6));
  const T safe = select(small, T(1), q);
  const T t = sqrt(safe);
  const T a = select(small, T(1) - q / T(6) + q * q / T(120), sin(t) / t);
  const T b = select(small, T(0.5) - q / T(24) + q * q / T(720), (T(1) - cos(t)) / safe);
  return Rigid<T>({{{T(1) - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y},
                    {b * x * y + a * z, T(1) - b * (x * x + z * z), b * y * z - a * x},
                    {b * x * z - a * y, b * y * z + a * x, T(1) - b * (x * x + y * y)}}},
                  {});
}

// v = t / sin(t) * vee, vee = the axial part (R - R^T)/2, |vee| = sin t, trace = 1 + 2 cos t.
template <class T>
Vector3<T> rotation_vector(const Matrix3<T>& R) {
  using std::atan2, std::sqrt;
  const T half(0.5);
  const Vector3<T> v{half * (R[2][1] - R[1][2]), half * (R[0][2] - R[2][0]),
                     half * (R[1][0] - R[0][1])};
  const T s2 = dot<T>(v, v), c = half * (R[0][0] + R[1][1] + R[2][2] - T(1));
  const T small = less(s2, T(1e-6)) * less(T(0), c);
  const T s = sqrt(select(small, T(1), s2));
  // asin(s)/s = 1 + s^2/6 + 3 s^4/40
  const T scale = select(small, T(1) + s2 / T(6) + T(0.075) * s2 * s2, atan2(s, c) / s);
  return {scale * v[0], scale * v[1], scale * v[2]};
}

}  // namespace talus
