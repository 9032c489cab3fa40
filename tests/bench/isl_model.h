// The instrumented spatial linkage of Bonny, Hull and Howell (2013), written by hand: "isl38".
//
//     T_B_E = Trans(xB,yB,zB) Rz(alphaB) Rx(betaB) Rz(gammaB)
//           * prod_{i=1..6} Rz(slope_i*theta_i + intercept_i) Tz(d_i) Tx(a_i) Rx(alpha_i)
//           * Trans(xE,yE,zE) Rz(alphaE) Rx(betaE) Rz(gammaE)
//
// with intercept_6 = d_6 = a_6 = alpha_6 = 0, which leaves 38 parameters, all free. Lengths are in
// mm, angles in rad. This is what somebody writes who needs this one linkage and no other; it
// shares no code with Talus, and is what Talus is measured against.
#pragma once

#include <array>
#include <cmath>

namespace talus::bench {

constexpr int isl_parameters = 38;
constexpr int isl_rows = 6;

// Where each group of parameters begins.
namespace isl_at {
constexpr int base = 0;        // xB yB zB alphaB betaB gammaB
constexpr int slope = 6;       // slope1..6
constexpr int intercept = 12;  // intercept1..5
constexpr int alpha = 17;      // alpha1..5
constexpr int a = 22;          // a1..5
constexpr int d = 27;          // d1..5
constexpr int end = 32;        // xE yE zE alphaE betaE gammaE
}  // namespace isl_at

using IslParameters = std::array<double, isl_parameters>;

// Each row of the residual is multiplied by its own factor (for weights: their square roots).
using IslFactors = std::array<double, isl_rows>;

// A frame in B that is moved along its own axes, one elementary motion after the other. With dual
// numbers this takes half the time of multiplying closed-form link matrices.
template <class T>
struct IslFrame {
  T rotation[3][3] = {{T(1), T(0), T(0)}, {T(0), T(1), T(0)}, {T(0), T(0), T(1)}};
  T position[3] = {T(0), T(0), T(0)};

  void translate(int axis, const T& by) {
    for (int i = 0; i < 3; ++i) position[i] += rotation[i][axis] * by;
  }
  void rotate_x(const T& angle) { rotate(1, 2, angle); }
  void rotate_z(const T& angle) { rotate(0, 1, angle); }

 private:
  void rotate(int from, int to, const T& angle) {
    using std::cos, std::sin;
    const T c = cos(angle), s = sin(angle);
    for (auto& row : rotation) {
      const T first = row[from], second = row[to];
      row[from] = c * first + s * second;
      row[to] = c * second - s * first;
    }
  }
};

// T_B_E of the model; `readings` are the six encoders' (rad).
template <class T>
IslFrame<T> isl_frame(const T* p, const double* readings) {
  IslFrame<T> frame;
  for (int i = 0; i < 3; ++i) frame.position[i] = p[isl_at::base + i];
  frame.rotate_z(p[isl_at::base + 3]);
  frame.rotate_x(p[isl_at::base + 4]);
  frame.rotate_z(p[isl_at::base + 5]);
  for (int i = 0; i < 5; ++i) {
    frame.rotate_z(p[isl_at::slope + i] * readings[i] + p[isl_at::intercept + i]);
    frame.translate(2, p[isl_at::d + i]);
    frame.translate(0, p[isl_at::a + i]);
    frame.rotate_x(p[isl_at::alpha + i]);
  }
  frame.rotate_z(p[isl_at::slope + 5] * readings[5]);
  for (int i = 0; i < 3; ++i) frame.translate(i, p[isl_at::end + i]);
  frame.rotate_z(p[isl_at::end + 3]);
  frame.rotate_x(p[isl_at::end + 4]);
  frame.rotate_z(p[isl_at::end + 5]);
  return frame;
}

}  // namespace talus::bench
