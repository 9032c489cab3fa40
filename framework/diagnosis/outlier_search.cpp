#include "framework/diagnosis/outlier_search.h"

#include <algorithm>
#include <cmath>

#include "framework/diagnosis/tails.h"

namespace talus {
namespace {

// Chance that the worst of all good poses is taken for a blunder, were their errors Gaussian.
constexpr double family_error = 0.01;
// A distance is compared in units of the bulk's: of its median, or of its eighth decile where that
// is larger, since what physics leaves out is not spread as noise is. (The ninth would be lost to
// blunders in one pose of ten.)
constexpr double upper_share = 0.8;
// What the bulk has beyond its noise is physics, whose largest values lie farther out than those of
// noise (at the ends of ranges, where few other poses tell): so many times as far is still bulk.
constexpr double room = 2;
// Of a pose held out still more: what physics does beyond the poses fitted, these do not tell.
constexpr double room_held_out = 3;
// Neighbours are elevated where their median exceeds the median of all by so much: of six good
// poses with three rows each, less than one time in a hundred.
constexpr double elevated = 1.7;
// A pose stands alone where it is so many times farther off than elevated neighbours are.
constexpr double alone = 3;
// Least trimmed squares goes by this share of the poses; the others may be anything.
constexpr double trusted = 0.75;
// With one pose in ten bad, a draw of twelve is clean one time in four.
constexpr int draws = 200, few_draws = 40, concentrations = 2, finalists = 5;
constexpr int most_settling = 15;

}  // namespace

OutlierSearch::OutlierSearch(const PoseBlocks& blocks, const std::vector<bool>& fitted,
                             const Neighbours& neighbours, bool noise_known, std::uint64_t seed)
    : blocks_(blocks),
      fitted_(fitted),
      neighbours_(neighbours),
      noise_known_(noise_known),
      random_(seed) {
  for (int k = 0; k < blocks_.poses(); ++k) {
    if (fitted_[k]) own_.push_back(k);
    const double f = blocks_.freedom(k);
    if (f > 0 && !limit_.contains(f)) {
      middle_[f] = chi2_quantile(std::log(0.5), f);
      decile_[f] = chi2_quantile(std::log(1 - upper_share), f);
      limit_[f] = chi2_quantile(std::log(family_error / blocks_.poses()), f);
    }
  }
}

Judged OutlierSearch::settle(std::vector<bool> in) const {
  Judged judged;
  for (int i = 0; i < most_settling; ++i) {
    judged = judge(in);
    std::vector<bool> next = fitted_;
    for (int k : own_) next[k] = !judged.out[k];
    if (next == in) break;
    in = std::move(next);
  }
  return judged;
}

// The sum of squares per degree of freedom of the trusted share that fits best, and which those
// are.
double OutlierSearch::trimmed(const PoseBlocks::Solution& solution, std::vector<bool>& best) const {
  std::vector<std::pair<double, int>> order;
  for (int k : own_)
    order.push_back({blocks_.squares(solution, k) / std::max(1.0, blocks_.freedom(k)), k});
  std::sort(order.begin(), order.end());
  order.resize(static_cast<std::size_t>(std::ceil(trusted * static_cast<double>(own_.size()))));
  best.assign(blocks_.poses(), false);
  double sum = 0;
  for (const auto& [square, k] : order) best[k] = true, sum += square;
  return sum;
}

std::vector<bool> OutlierSearch::least_trimmed() {
  // As many poses as determine the directions, with a few rows to spare.
  double rows = 0;
  for (int k : own_) rows += blocks_.freedom(k);
  const int n = static_cast<int>(own_.size());
  const double needed = 1.2 * blocks_.directions() / std::max(1.0, rows / n);
  const int few = std::min(n, static_cast<int>(std::ceil(needed)) + 1);
  const int tries = std::clamp(draws * 300 / n, few_draws, draws);
  std::vector<std::pair<double, std::vector<bool>>> found;
  std::vector<int> order;
  for (int t = 0; t <= tries; ++t) {
    std::vector<bool> in(blocks_.poses(), false), next;
    if (t == 0) {
      in = fitted_;
    } else {
      order = own_;
      for (int i = 0; i < few; ++i) {
        const int left = n - i;
        std::swap(order[i], order[i + static_cast<int>(random_() % static_cast<unsigned>(left))]);
        in[order[i]] = true;
      }
    }
    double value = 0;
    for (int c = 0; c < concentrations; ++c) {
      value = trimmed(blocks_.fit(in), next);
      in.swap(next);
    }
    found.push_back({value, in});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  found.resize(std::min<std::size_t>(found.size(), finalists));
  for (auto& [value, in] : found)
    for (int c = 0; c < 50; ++c) {
      std::vector<bool> next;
      value = trimmed(blocks_.fit(in), next);
      if (next == in) break;
      in.swap(next);
    }
  return std::min_element(found.begin(), found.end(),
                          [](const auto& a, const auto& b) { return a.first < b.first; })
      ->second;
}

Judged OutlierSearch::judge(const std::vector<bool>& in) const {
  Judged j;
  const int n = blocks_.poses();
  j.solution = blocks_.fit(in);
  j.out.assign(n, false);
  j.distance.assign(n, 0);
  j.beyond.assign(n, 0);
  std::vector<double> to_middle, to_decile, misfit(n, 0);
  for (int k = 0; k < n; ++k) {
    const double f = blocks_.freedom(k);
    if (!(f > 0)) continue;
    const double d2 = blocks_.distance2(j.solution, k);
    j.distance[k] = std::sqrt(d2);
    misfit[k] = std::sqrt(d2 / middle_.at(f));
    if (fitted_[k])
      to_middle.push_back(misfit[k]), to_decile.push_back(std::sqrt(d2 / decile_.at(f)));
  }
  if (to_middle.empty()) return j;
  j.scale = median(to_middle);
  const auto decile = to_decile.begin() + static_cast<long>(upper_share * to_decile.size());
  std::nth_element(to_decile.begin(), decile, to_decile.end());
  const double bulk = std::max(j.scale, *decile);
  auto unit = [&](double times) {
    return noise_known_ ? std::sqrt(1 + times * times * std::max(0.0, bulk * bulk - 1)) : bulk;
  };
  for (int k = 0; k < n; ++k) {
    const double f = blocks_.freedom(k);
    if (!(f > 0)) continue;
    double limit = unit(fitted_[k] ? room : room_held_out) * std::sqrt(limit_.at(f));
    if (j.distance[k] <= limit) continue;
    const double level = neighbours_.level(misfit, k, elevated) * std::sqrt(middle_.at(f));
    limit = std::max(limit, alone * level);
    j.beyond[k] = j.distance[k] / limit;
    if (j.beyond[k] > 1)
      j.out[k] = true;
    else
      ++j.clustered;
  }
  return j;
}

}  // namespace talus
