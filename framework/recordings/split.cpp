#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include "framework/recordings/recordings.h"

namespace talus {
namespace {

// Sets of rows that grow together (union-find).
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[root(b)] = root(a); }

 private:
  std::vector<std::size_t> parent_;
};

using Rows = std::vector<std::size_t>;

// Cuts a set of rows wherever `column`, sorted by size, jumps by more than `tolerance`.
void cut(const std::vector<double>& column, double tolerance, Rows rows,
         std::vector<Rows>& pieces) {
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::size_t a, std::size_t b) { return column[a] < column[b]; });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i == 0 || column[rows[i]] - column[rows[i - 1]] > tolerance) pieces.emplace_back();
    pieces.back().push_back(rows[i]);
  }
}

// Rows with the same readings. Cut by one reading after the other until nothing falls apart.
std::vector<Rows> repeats(const std::vector<const RecordedColumn*>& readings, std::size_t n,
                          double tolerance) {
  Rows complete;  // a row with a missing reading repeats nothing
  for (std::size_t row = 0; row < n; ++row)
    if (std::none_of(readings.begin(), readings.end(),
                     [&](auto* c) { return std::isnan(c->values[row]); }))
      complete.push_back(row);
  std::vector<Rows> sets{complete};
  for (std::size_t before = 0; before != sets.size();) {
    before = sets.size();
    for (const RecordedColumn* reading : readings) {
      std::vector<Rows> pieces;
      for (Rows& rows : sets) cut(reading->values, tolerance, std::move(rows), pieces);
      sets = std::move(pieces);
    }
  }
  return sets;
}

const RecordedColumn& column(const Recordings& recordings, const std::string& name) {
  const RecordedColumn* found = recordings.find(name);
  return found ? *found : recordings.get(name, number);  // throws: there is none
}

std::vector<int> groups(const Recordings& recordings, const SplitOptions& options) {
  const std::size_t n = recordings.rows();
  Sets sets(n);
  for (const std::vector<std::string>& together : options.group_columns) {
    std::map<std::vector<double>, std::size_t> first;
    for (std::size_t row = 0; row < n; ++row) {
      std::vector<double> key;
      for (const std::string& name : together) key.push_back(column(recordings, name).values[row]);
      if (std::none_of(key.begin(), key.end(), [](double x) { return std::isnan(x); }))
        sets.join(first.try_emplace(key, row).first->second, row);
    }
  }
  std::vector<const RecordedColumn*> readings;
  for (const std::string& name : options.reading_columns)
    readings.push_back(&column(recordings, name));
  if (!readings.empty())
    for (const Rows& rows : repeats(readings, n, options.repeat_tolerance))
      for (std::size_t row : rows) sets.join(rows[0], row);
  std::map<std::size_t, int> number_of;
  std::vector<int> group(n);
  for (std::size_t row = 0; row < n; ++row)
    group[row] =
        number_of.try_emplace(sets.root(row), static_cast<int>(number_of.size())).first->second;
  return group;
}

// 0 ... n-1 in an order that depends on the seed alone, on every platform.
std::vector<int> shuffled(int n, std::uint64_t seed) {
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::mt19937_64 random(seed);
  for (int i = n - 1; i > 0; --i) std::swap(order[i], order[random() % (i + 1)]);
  return order;
}

int count_groups(const std::vector<int>& group) {
  return group.empty() ? 0 : *std::max_element(group.begin(), group.end()) + 1;
}

}  // namespace

Split split_rows(const Recordings& recordings, const SplitOptions& options) {
  if (!(options.check_share >= 0 && options.check_share < 1))
    throw InputError(Place{},
                     fmt::format("a share of {} of the rows to check", options.check_share),
                     "a number from 0 to less than 1");
  Split split;
  split.group = groups(recordings, options);
  std::vector<bool> to_check(recordings.rows(), false);
  if (recordings.use) {
    to_check = *recordings.use;
    to_check.flip();
  } else if (const int n = count_groups(split.group); n > 1 && options.check_share > 0) {
    const int drawn = std::clamp(static_cast<int>(std::lround(options.check_share * n)), 1, n - 1);
    std::vector<bool> held_out(n, false);
    const std::vector<int> order = shuffled(n, options.seed);
    for (int i = 0; i < drawn; ++i) held_out[order[i]] = true;
    for (std::size_t row = 0; row < to_check.size(); ++row)
      to_check[row] = held_out[split.group[row]];
  }
  for (std::size_t row = 0; row < to_check.size(); ++row)
    (to_check[row] ? split.check : split.fit).push_back(row);
  if (split.fit.empty())
    throw InputError(Place{recordings.file}, "no row is to be fitted",
                     "the word fit in some rows of the column 'use'");
  return split;
}

std::vector<std::vector<std::size_t>> folds(const std::vector<int>& group, int k,
                                            std::uint64_t seed) {
  const int n = count_groups(group);
  if (std::min(k, n) < 2) return {};
  std::vector<std::vector<std::size_t>> rows_of(n), held_out(std::min(k, n));
  for (std::size_t row = 0; row < group.size(); ++row) rows_of[group[row]].push_back(row);
  for (int g : shuffled(n, seed)) {
    auto smallest =
        std::min_element(held_out.begin(), held_out.end(),
                         [](const auto& a, const auto& b) { return a.size() < b.size(); });
    smallest->insert(smallest->end(), rows_of[g].begin(), rows_of[g].end());
  }
  for (auto& rows : held_out) std::sort(rows.begin(), rows.end());
  return held_out;
}

}  // namespace talus
