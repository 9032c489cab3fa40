#include "framework/diagnosis/blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace talus {
namespace {

constexpr double kEnd = 1.0 / 6;        // share of the rows in a region
constexpr std::size_t kLeastPoses = 8;  // in a block, and three times as many outside
constexpr std::size_t kFew = 6;         // values: levels rather than a range

double judged(const BlockModel& model, const Recordings& recordings, const Split& split,
              FitOptions options) {
  options.restarts = 0;
  options.start = model.start;
  return calibrate(*model.program, recordings, split, options).heldout_rms;
}

}  // namespace

BlockCovariate block_covariate(const RecordedColumn& column) {
  return {column.name, column.unit.text, column.unit.factor, column.values};
}

std::vector<Block> held_out_blocks(const BlockModel& given, const BlockModel& extended,
                                   const Recordings& recordings, const Split& split,
                                   const std::vector<BlockCovariate>& covariates,
                                   const FitOptions& options) {
  std::vector<Block> blocks;
  auto hold_out = [&](const std::string& name, const std::function<bool(std::size_t)>& inside) {
    Split block;
    for (std::size_t row : split.fit) (inside(row) ? block.check : block.fit).push_back(row);
    for (std::size_t row : split.check)
      if (inside(row)) block.check.push_back(row);
    std::sort(block.check.begin(), block.check.end());
    if (block.check.size() < kLeastPoses || block.fit.size() < 3 * kLeastPoses) return;
    Block b{name, block.check.size()};
    try {
      b.before = judged(given, recordings, block, options);
      b.after = judged(extended, recordings, block, options);
    } catch (const InputError&) {
      return;  // cannot be evaluated without these rows
    }
    blocks.push_back(b);
  };
  for (const BlockCovariate& c : covariates) {
    std::vector<double> sorted;
    for (std::size_t row : split.fit)
      if (!std::isnan(c.values[row])) sorted.push_back(c.values[row]);
    std::sort(sorted.begin(), sorted.end());
    std::vector<double> distinct = sorted;
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    if (distinct.size() < 2) continue;
    auto words = [&](const char* side, double at) {
      return fmt::format("{} {} {:.4g} {}", c.name, side, at / c.factor, c.unit);
    };
    if (distinct.size() <= kFew) {
      for (const double v : {distinct.front(), distinct.back()})
        hold_out(words("at", v), [&](std::size_t row) { return c.values[row] == v; });
      continue;
    }
    const auto end = static_cast<std::size_t>(kEnd * static_cast<double>(sorted.size()));
    if (end == 0) continue;
    const double low = sorted[end], high = sorted[sorted.size() - 1 - end];
    hold_out(words("below", low), [&](std::size_t row) { return c.values[row] < low; });
    hold_out(words("above", high), [&](std::size_t row) { return c.values[row] > high; });
  }
  if (const RecordedColumn* session = recordings.find("session")) {
    double first = INFINITY, last = -INFINITY;
    for (std::size_t row : split.fit) {
      first = std::fmin(first, session->values[row]);
      last = std::fmax(last, session->values[row]);
    }
    if (last > first)
      hold_out(fmt::format("session {:g}", last),
               [&](std::size_t row) { return session->values[row] == last; });
  }
  return blocks;
}

}  // namespace talus
