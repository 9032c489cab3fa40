// What a Screen keeps. A test is a form with its change point, in coordinates that make its signal
// orthonormal: z = whiten^T X^T y for projected rows y.
#pragma once

#include <algorithm>
#include <cmath>

#include "framework/diagnosis/screen.h"

namespace talus {

struct Test {
  Pick pick;
  int freedom = 0;           // of `strength`, those that are tested: they stand first
  double visible = 0;        // |X~ D| / |X D|
  Eigen::MatrixXd whiten;    // D V diag(1/s): amounts x directions
  Eigen::VectorXd strength;  // s, decreasing; directions that the geometry absorbs are left out
  Eigen::MatrixXd share;     // c^2 s^2 / (c^2 s^2 + noise): directions x scales
  Eigen::VectorXd penalty;  // 1/2 sum ln(1 + c^2 s^2 / noise) of each scale, and ln of their number
};

struct Screen::Inside {
  ScreenOptions options;
  Candidates candidates;   // rows in the order of time
  std::vector<int> order;  // the caller's number of each of these rows
  std::vector<int> pose;   // of each of these rows
  std::vector<int> place;  // first row of each place in time, and the end
  Eigen::VectorXd rest;    // w projected; the priors' rows stand last, as in Q
  Eigen::MatrixXd Q;
  bool noise_known = true;
  double taken = 0, freedom = 0, chi2 = 0;
  double noise = 1;  // variance of a row

  std::vector<Test> tests;       // form by form, change points in order
  std::vector<int> first;        // test of each form, and the end
  bool any_whole = false;        // forms without onset
  std::vector<int> onset_start;  // of each form: its first of the columns with onset
  Eigen::MatrixXd onset_columns;
  std::vector<std::vector<int>> at_place;  // tests that set in there

  void build();
  void build_whole(int form);
  void build_onsets();
  Test decompose(const Pick& pick, const Eigen::MatrixXd& gram, double size, double floor) const;
  const Test& test(const Pick& pick) const;
  Eigen::MatrixXd project(const Eigen::MatrixXd& data_rows) const;  // all rows
  Eigen::MatrixXd columns(const Pick& pick) const;  // data rows; zero before the onset

  // f(test, b) for all tests, b = X^T y (amounts x columns of y); y is projected.
  template <class F>
  void each(const Eigen::Ref<const Eigen::MatrixXd>& y, F f) const;
  double log_bayes(const Test& test, const Eigen::VectorXd& z, double chi2_of_rows) const;
  double log_p(double explained, double directions, double chi2_of_rows, bool known) const;
  double likely_scale(const Test& test, const Eigen::VectorXd& z, double left) const;
  Score score(const Test& test, const Eigen::VectorXd& b) const;
};

double log_sum(const std::vector<double>& logs);  // ln of the sum of exp
double log_mean(const std::vector<double>& logs);

template <class F>
void Screen::Inside::each(const Eigen::Ref<const Eigen::MatrixXd>& y, F f) const {
  const auto& forms = candidates.forms;
  Eigen::MatrixXd b;
  if (any_whole) {
    const Eigen::MatrixXd all =
        candidates.columns.transpose() * y.topRows(candidates.columns.rows());
    for (std::size_t i = 0; i < forms.size(); ++i) {
      if (forms[i].onset) continue;
      b = all(forms[i].columns, Eigen::all);
      f(first[i], b);
    }
  }
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(onset_columns.cols(), y.cols());
  if (onset_columns.cols() == 0) return;
  for (int p = static_cast<int>(place.size()) - 2; p > 0; --p) {
    const int from = place[p], count = place[p + 1] - from;
    sum.noalias() += onset_columns.middleRows(from, count).transpose() * y.middleRows(from, count);
    for (const int t : at_place[p]) {
      const int form = tests[t].pick.form;
      b = sum.middleRows(onset_start[form], static_cast<Eigen::Index>(forms[form].columns.size()));
      f(t, b);
    }
  }
}

}  // namespace talus
