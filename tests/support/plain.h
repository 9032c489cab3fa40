// Plain homogeneous 4x4 matrices of doubles, written out: an independent arithmetic against which
// plugins are tested, and plugins run on numbers.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "framework/registry/registry.h"

namespace talus::testing {

using Matrix4 = std::array<std::array<double, 4>, 4>;

inline Matrix4 operator*(const Matrix4& a, const Matrix4& b) {
  Matrix4 c{};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

inline Matrix4 trans(double x, double y, double z) {
  return {{{1, 0, 0, x}, {0, 1, 0, y}, {0, 0, 1, z}, {0, 0, 0, 1}}};
}
inline Matrix4 rot_x(double t) {
  const double c = std::cos(t), s = std::sin(t);
  return {{{1, 0, 0, 0}, {0, c, -s, 0}, {0, s, c, 0}, {0, 0, 0, 1}}};
}
inline Matrix4 rot_y(double t) {
  const double c = std::cos(t), s = std::sin(t);
  return {{{c, 0, s, 0}, {0, 1, 0, 0}, {-s, 0, c, 0}, {0, 0, 0, 1}}};
}
inline Matrix4 rot_z(double t) {
  const double c = std::cos(t), s = std::sin(t);
  return {{{c, -s, 0, 0}, {s, c, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
}

inline double farthest(const Matrix4& a, const Matrix4& b) {
  double most = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const double d = std::abs(a[i][j] - b[i][j]);
      if (!(d <= most)) most = d;  // a NaN stays
    }
  return most;
}

// Traced numbers stay numbers: a plugin run on constants gives constants.
inline std::vector<Expr> constants(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

inline Matrix4 plain(const Rigid<Expr>& t) {
  const auto R = t.rotation();
  const auto p = t.translation();
  Matrix4 m{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m[i][j] = R[i][j].constant();
    m[i][3] = p[i].constant();
  }
  m[3][3] = 1;
  return m;
}

inline Rigid<Expr> rigid(const Matrix4& m) {
  Matrix3<Expr> R;
  Vector3<Expr> p;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R[i][j] = m[i][j];
    p[i] = m[i][3];
  }
  return {R, p};
}

inline const Plugin& plugin(const char* tag, Family family) {
  const Plugin* found = Registry::built_in().find(tag, family);
  if (!found) throw InputError(std::string("no ") + to_string(family) + " " + tag);
  return *found;
}

inline Matrix4 run_joint(const char* tag, const std::vector<double>& inputs,
                         const std::vector<int>& choices = {}) {
  return plain(plugin(tag, Family::joint).transform(constants(inputs), choices));
}

inline double run_sensor(const char* tag, double reading, const std::vector<double>& inputs,
                         const std::vector<int>& choices = {}) {
  return plugin(tag, Family::sensor).value(reading, constants(inputs), choices).constant();
}

inline Observed<Expr> run_feature(const char* tag, const std::vector<double>& columns) {
  return plugin(tag, Family::feature).observe(constants(columns), {});
}

inline std::vector<double> run_residual(const char* tag, const Matrix4& model,
                                        const Observed<Expr>& measured,
                                        const std::vector<double>& inputs = {}) {
  std::vector<double> rows;
  for (const Expr& row :
       plugin(tag, Family::residual).rows(rigid(model), measured, constants(inputs), {}))
    rows.push_back(row.constant());
  return rows;
}

}  // namespace talus::testing
