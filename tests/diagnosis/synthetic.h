// A chain of hinges measured as a full pose, made linear: what a screen is given, with the truth
// known. Columns are twists d at a named place of the chain times a function of the pose.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <numbers>
#include <random>

#include "framework/diagnosis/screen.h"

namespace talus::testing {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

struct Chain {
  int poses = 0, joints = 6;
  Eigen::MatrixXd theta;                 // poses x joints
  std::vector<std::vector<Matrix6>> at;  // [pose][place]: twist there -> whitened rows
  Baseline baseline;
  Candidates candidates;

  Eigen::VectorXd column(int place, int direction, const std::function<double(int)>& f) const {
    Eigen::VectorXd x(6 * poses);
    for (int k = 0; k < poses; ++k) x.segment<6>(6 * k) = at[k][place].col(direction) * f(k);
    return x;
  }
  int add(const Eigen::VectorXd& x, double typical) {
    auto& X = candidates.columns;
    X.conservativeResize(x.size(), X.cols() + 1);
    X.rightCols(1) = x;
    candidates.typical.conservativeResize(X.cols());
    candidates.typical.tail(1)[0] = typical;
    return static_cast<int>(X.cols()) - 1;
  }
};

inline Eigen::VectorXd noise(Eigen::Index size, std::uint64_t seed, double sigma = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, sigma);
  Eigen::VectorXd x(size);
  for (double& v : x) v = normal(random);
  return x;
}

// Joints move within +-range; rows are 0.05 mm and 0.0005 rad each.
inline Chain chain(int poses, double range, std::uint64_t seed) {
  Chain c;
  c.poses = poses;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  c.theta.resize(poses, c.joints);
  for (int i = 0; i < c.joints; ++i)
    for (int k = 0; k < poses; ++k) c.theta(k, i) = range * uniform(random);
  Eigen::VectorXd sigma(6);
  sigma << 0.05, 0.05, 0.05, 5e-4, 5e-4, 5e-4;
  c.at.resize(poses);
  for (int k = 0; k < poses; ++k) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();  // of the place, seen from the tip
    for (int i = c.joints; i >= 0; --i) {
      if (i < c.joints)
        T = T * Eigen::AngleAxisd(i % 2 ? 1.5 : -1.3, Eigen::Vector3d::UnitX()) *
            Eigen::Translation3d(-60.0 - 20 * i, 0, 40) *
            Eigen::AngleAxisd(-c.theta(k, i), Eigen::Vector3d::UnitZ());
      Matrix6 A = Matrix6::Zero();
      const Eigen::Matrix3d R = T.linear();
      const Eigen::Vector3d p = T.translation();
      Eigen::Matrix3d cross;
      cross << 0, -p.z(), p.y(), p.z(), 0, -p.x(), -p.y(), p.x(), 0;
      A.topLeftCorner<3, 3>() = A.bottomRightCorner<3, 3>() = R;
      A.topRightCorner<3, 3>() = cross * R;
      c.at[k].insert(c.at[k].begin(), sigma.cwiseInverse().asDiagonal() * A);
    }
  }
  for (int k = 0; k < poses; ++k)
    for (int r = 0; r < 6; ++r) c.baseline.pose.push_back(k);
  Eigen::MatrixXd J(6 * poses, 6 * (c.joints + 1));
  for (int i = 0; i <= c.joints; ++i)
    for (int d = 0; d < 6; ++d) J.col(6 * i + d) = c.column(i, d, [](int) { return 1.0; });
  c.baseline.columns = J;  // all places, all directions: many gauges
  c.baseline.rows = noise(6 * poses, seed + 1);
  return c;
}

// Suspects of every joint: eccentricity, second harmonic, interpolation of several orders, gain,
// wobble and runout, drift, coupling, slips and shifts.
inline void suspect_all(Chain& c) {
  int suspect = 0;
  auto f = [&c](int i, double order, double phase) {
    return [&c, i, order, phase](int k) { return std::cos(order * c.theta(k, i) - phase); };
  };
  auto& forms = c.candidates.forms;
  const double half = std::numbers::pi / 2;
  for (int i = 0; i < c.joints; ++i) {
    for (const double order : {1.0, 2.0})
      forms.push_back({.suspect = suspect++,
                       .columns = {c.add(c.column(i, 5, f(i, order, 0)), 1e-3),
                                   c.add(c.column(i, 5, f(i, order, half)), 1e-3)}});
    for (int order = 8; order < 24; ++order)
      forms.push_back({.suspect = suspect,
                       .columns = {c.add(c.column(i, 5, f(i, order, 0)), 5e-4),
                                   c.add(c.column(i, 5, f(i, order, half)), 5e-4)}});
    ++suspect;
    for (int j = 0; j < c.joints; ++j)
      forms.push_back(
          {.suspect = suspect++,
           .columns = {c.add(c.column(i, 5, [&](int k) { return c.theta(k, j); }), 1e-3)}});
    for (const int first : {0, 3})
      for (const double order : {1.0, 2.0, 3.0}) {
        Form form{.suspect = suspect};
        for (const int d : {first, first + 1})
          for (const double phase : {0.0, half})
            form.columns.push_back(
                c.add(c.column(i, d, f(i, order, phase)), first == 0 ? 0.02 : 2e-4));
        forms.push_back(form);
        if (order == 3) ++suspect;
      }
    for (int d = 0; d < 6; ++d)
      forms.push_back({.suspect = suspect++,
                       .columns = {c.add(c.column(i, d, [&](int k) { return k * 1.0 / c.poses; }),
                                         d < 3 ? 0.05 : 5e-4)}});
    forms.push_back({.suspect = suspect++,
                     .columns = {c.add(c.column(i, 5, [](int) { return 1.0; }), 1e-3)},
                     .onset = true});
  }
  Form shift{.suspect = suspect++, .onset = true};
  for (int d = 0; d < 6; ++d)
    shift.columns.push_back(c.add(c.column(0, d, [](int) { return 1.0; }), d < 3 ? 0.05 : 5e-4));
  forms.push_back(shift);
}

// A joint's compliance and the torsion of the link before it: one column, other units.
inline int add_twin(Chain& c, int form, double factor, int suspect) {
  Form twin{.suspect = suspect};
  for (const int column : c.candidates.forms[form].columns)
    twin.columns.push_back(c.add(Eigen::VectorXd(factor * c.candidates.columns.col(column)),
                                 c.candidates.typical[column] / factor));
  c.candidates.forms.push_back(twin);
  return static_cast<int>(c.candidates.forms.size()) - 1;
}

}  // namespace talus::testing
