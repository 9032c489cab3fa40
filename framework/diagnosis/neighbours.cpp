#include "framework/diagnosis/neighbours.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace talus {
namespace {

constexpr std::size_t around = 6;  // poses of a neighbourhood on both sides, as far as there are
constexpr std::size_t beside = 5;  // and of one on one side: a step has those on one side only
// So many of them must be elevated, or else two blunders that happen to be neighbours in one of
// many columns would vouch for each other: with one pose in ten bad, that happens to one in forty.
constexpr std::size_t needed_around = 4, needed_beside = 4;
constexpr std::size_t repeats = 6;  // more equal values than this are the neighbourhood themselves

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

std::vector<PoseOrder> pose_orders(const Recordings& recordings,
                                   const std::vector<std::size_t>& rows,
                                   const std::vector<std::string>& without) {
  std::vector<PoseOrder> orders(1);
  orders[0].name = "order";
  const RecordedColumn* pose = recordings.find("pose");
  for (std::size_t row : rows)
    orders[0].values.push_back(pose ? pose->values[row] : static_cast<double>(row));
  for (const RecordedColumn& c : recordings.columns) {
    if (&c == pose || std::find(without.begin(), without.end(), c.name) != without.end()) continue;
    PoseOrder order{c.name, {}};
    for (std::size_t row : rows) order.values.push_back(c.values[row]);
    if (std::any_of(order.values.begin(), order.values.end(),
                    [&](double v) { return v != order.values[0]; }))
      orders.push_back(std::move(order));
  }
  return orders;
}

Neighbours::Neighbours(const std::vector<PoseOrder>& orders) {
  for (const PoseOrder& order : orders) {
    std::vector<int> sorted;
    for (std::size_t k = 0; k < order.values.size(); ++k)
      if (!std::isnan(order.values[k])) sorted.push_back(static_cast<int>(k));
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&](int a, int b) { return order.values[a] < order.values[b]; });
    Line line{std::move(sorted), std::vector<std::array<std::size_t, 3>>(order.values.size())};
    const std::size_t n = line.sorted.size();
    for (std::size_t first = 0, last = 0; first < n; first = last) {
      while (last < n && order.values[line.sorted[last]] == order.values[line.sorted[first]])
        ++last;
      for (std::size_t i = first; i < last; ++i) line.at[line.sorted[i]] = {i, first, last};
    }
    lines_.push_back(std::move(line));
  }
}

double Neighbours::level(std::span<const double> misfit, int pose, double elevated) const {
  const double least = elevated * median({misfit.begin(), misfit.end()});
  double level = 0;
  std::vector<double> of;
  // What at least `needed` of the poses from `from` up to `to` reach.
  auto look = [&](const Line& line, std::size_t from, std::size_t to, std::size_t needed) {
    of.clear();
    for (std::size_t j = from; j < to; ++j)
      if (line.sorted[j] != pose) of.push_back(misfit[line.sorted[j]]);
    if (of.size() < needed) return;
    std::nth_element(of.begin(), of.begin() + static_cast<long>(needed - 1), of.end(),
                     std::greater<>());
    if (of[needed - 1] > least) level = std::max(level, of[needed - 1]);
  };
  for (const Line& line : lines_) {
    const auto [i, first, last] = line.at[pose];
    const std::size_t n = line.sorted.size();
    if (last == first) continue;  // not known of this pose
    if (last - first > repeats) {
      look(line, first, last, (last - first + 1) / 2);
      continue;
    }
    const std::size_t from =
        std::min(i > around / 2 ? i - around / 2 : 0, n > around + 1 ? n - around - 1 : 0);
    look(line, from, std::min(n, from + around + 1), needed_around);
    look(line, i > beside ? i - beside : 0, i, needed_beside);
    look(line, i + 1, std::min(n, i + 1 + beside), needed_beside);
  }
  return level;
}

}  // namespace talus
