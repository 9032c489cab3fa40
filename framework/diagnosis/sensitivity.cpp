#include "framework/diagnosis/sensitivity.h"

#include <algorithm>
#include <limits>
#include <map>
#include <random>

#include "framework/diagnosis/screen_inside.h"
#include "framework/diagnosis/tails.h"

namespace talus {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

// The median over directions u of sum s^2 u^2. Of a pair this is the mean, that of 45 degrees;
// directions of more amounts are drawn, always the same.
double median_power(const VectorXd& strength, Index amounts) {
  const VectorXd power = strength.cwiseAbs2();
  if (amounts <= 2) return power.sum() / static_cast<double>(amounts);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> drawn(501);
  for (double& d : drawn) {
    double sum = 0, length = 0;
    for (Index j = 0; j < amounts; ++j) {
      const double u = std::pow(normal(random), 2);
      length += u;
      if (j < power.size()) sum += power[j] * u;
    }
    d = sum / length;
  }
  std::nth_element(drawn.begin(), drawn.begin() + 250, drawn.end());
  return drawn[250];
}

struct Magnitudes {
  double median = never, best = never, worst = never;
  const Test* test = nullptr;
};

}  // namespace

std::vector<Sensitivity> sensitivity(const Screen& screen, const SensitivityOptions& options) {
  const Screen::Inside& in = screen.inside();
  std::map<int, double> needed;
  auto need = [&](int freedom) {
    const auto [at, fresh] = needed.try_emplace(freedom, 0);
    if (fresh)
      at->second = needed_noncentrality(options.log_threshold, freedom, options.power) * in.noise;
    return at->second;
  };
  std::map<int, std::vector<Magnitudes>> suspects;
  for (const Test& t : in.tests) {
    const Form& form = in.candidates.forms[t.pick.form];
    const auto amounts = static_cast<Index>(form.columns.size());
    Magnitudes m{.test = &t};
    if (t.strength.size() > 0) {
      const double ncp = need(std::max(1, t.freedom));
      m.median = std::sqrt(ncp / median_power(t.strength, amounts));
      m.best = std::sqrt(ncp) / t.strength[0];
      if (t.strength.size() == amounts) m.worst = std::sqrt(ncp) / t.strength[amounts - 1];
    }
    suspects[form.suspect].push_back(m);
  }
  std::vector<Sensitivity> result;
  std::vector<Pick> picks;
  for (auto& [suspect, all] : suspects) {
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>((all.size() - 1) / 2);
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.median < b.median; });
    Sensitivity s{.suspect = suspect, .pick = middle->test->pick};
    s.smallest_visible = middle->median;
    s.visible = middle->test->visible;
    s.best = never;
    s.worst = 0;
    for (const Magnitudes& m : all) {
      s.best = std::min(s.best, m.best);
      s.worst = std::max(s.worst, m.worst);
    }
    result.push_back(s);
    picks.push_back(s.pick);
  }
  const auto rivals = screen.rivals(picks);
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (std::isinf(result[i].smallest_visible)) continue;
    for (const Rival& r : rivals[i]) {
      const int other = in.candidates.forms[r.pick.form].suspect;
      if (other == result[i].suspect || r.imitates <= result[i].imitates) continue;
      result[i].nearest = other;
      result[i].nearest_pick = r.pick;
      result[i].imitates = r.imitates;
    }
  }
  return result;
}

}  // namespace talus
