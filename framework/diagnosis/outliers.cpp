#include "framework/diagnosis/outliers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "framework/calibration/fit.h"
#include "framework/diagnosis/outlier_search.h"
#include "framework/diagnosis/refit.h"

namespace talus {
namespace {

// More poses than this are no blunders but a group of their own.
constexpr double most = 0.15;
constexpr int rounds = 5;
// So many poses that are far outside, all of them and no others with one value in some column, are
// no blunders: chance does not choose them so.
constexpr std::size_t kOfAKind = 3;

// "1.2 mm and 0.3 deg": the root of the sum of squares of the rows of each dimension.
std::string size_of(const std::vector<double>& off, const Program& program) {
  std::vector<std::string> words;
  for (Dimension dimension : {length, angle, number}) {
    double sum = 0;
    bool any = false;
    for (std::size_t r = 0; r < off.size(); ++r)
      if (program.rows[r].dimension == dimension && !std::isnan(off[r]))
        sum += off[r] * off[r], any = true;
    const Unit unit = program.units.of(dimension);
    if (any)
      words.push_back(fmt::format("{:.3g}{}{}", std::sqrt(sum) / unit.factor,
                                  unit.text.empty() ? "" : " ", unit.text));
  }
  return fmt::format("{}", fmt::join(words, " and "));
}

std::string summary(const Outliers& result) {
  const std::size_t n = result.found.size();
  if (n == 0) return {};
  std::vector<std::string> poses;
  for (const Outlier& o : result.found) poses.push_back(std::to_string(o.pose));
  return fmt::format("{} of {} poses {} far outside the others and alone: {}.", n, result.judged,
                     n == 1 ? "lies" : "lie", fmt::join(poses, ", "));
}

// Takes poses that have something recorded in common back in. Says how many.
std::size_t spare_kinds(const Recordings& recordings, const std::vector<std::size_t>& rows,
                        const std::vector<std::string>& measured, std::vector<bool>& out) {
  std::size_t spared = 0;
  for (const RecordedColumn& c : recordings.columns) {
    if (std::find(measured.begin(), measured.end(), c.name) != measured.end()) continue;
    std::map<double, std::vector<std::size_t>> kinds;
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (!std::isnan(c.values[rows[k]])) kinds[c.values[rows[k]]].push_back(k);
    for (const auto& [value, poses] : kinds) {
      if (poses.size() < kOfAKind ||
          !std::all_of(poses.begin(), poses.end(), [&](std::size_t k) { return out[k]; }))
        continue;
      for (const std::size_t k : poses) out[k] = false;
      spared += poses.size();
    }
  }
  return spared;
}

}  // namespace

std::vector<std::size_t> Outliers::keep(const std::vector<std::size_t>& rows) const {
  std::vector<std::size_t> kept = rows;
  std::erase_if(kept, [&](std::size_t row) {
    return std::any_of(found.begin(), found.end(), [&](const Outlier& o) { return o.row == row; });
  });
  return kept;
}

Outliers find_outliers(const Program& program, const Recordings& recordings, const Split& split,
                       std::span<const double> x, const OutlierOptions& options) {
  Outliers result;
  result.x.assign(x.begin(), x.end());
  const Groups groups(program, recordings);
  ProblemOptions plain;
  plain.threads = options.threads;
  plain.robust = false;
  const Plan plan = plan_for(program, groups, plain);
  const std::vector<double> fsr = full_scale_ranges(program, recordings);
  // Rows held out cannot be predicted where their group has unknowns of its own.
  std::vector<std::size_t> rows = split.fit;
  if (options.held_out && groups.shared.empty())
    rows.insert(rows.end(), split.check.begin(), split.check.end());
  std::sort(rows.begin(), rows.end());
  std::vector<bool> fitted(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k)
    fitted[k] = std::find(split.fit.begin(), split.fit.end(), rows[k]) != split.fit.end();
  Problem all(program, plan, recordings, rows, groups, plain);
  if (program.settings.full_scale) all.divide_rows_by(fsr);
  result.judged = rows.size();

  std::vector<std::string> measured;
  for (const MeasuredColumn& c : program.columns) measured.push_back(c.name);
  Judged judged;
  Problem::Residuals residuals;
  std::vector<bool> before;
  for (int round = 0; round < rounds; ++round) {
    all.reset_latent_values();
    if (all.latents() > 0) all.scatter_latents(result.x, options.seed);
    all.set_weights(result.x);
    residuals = all.residuals(result.x);
    std::vector<PoseOrder> orders = pose_orders(recordings, rows, measured);
    for (Eigen::Index i = 0; i < residuals.latent.cols(); ++i) {
      const auto values = residuals.latent.col(i);
      orders.push_back({"latent", {values.begin(), values.end()}});
    }
    const Neighbours neighbours(orders);
    if (!all.noise_known()) {
      std::vector<double> squares;
      for (Eigen::Index k = 0; k < residuals.whitened.rows(); ++k)
        squares.push_back(residuals.whitened.row(k).squaredNorm() /
                          static_cast<double>(residuals.whitened.cols()));
      all.set_noise_variance(std::max(1e-300, median(squares)));
    }
    const PoseBlocks blocks(all, all.linear(result.x), result.x, fitted);
    OutlierSearch search(blocks, fitted, neighbours, all.noise_known(), options.seed);
    judged = search.settle(search.least_trimmed());
    judged.clustered += spare_kinds(recordings, rows, measured, judged.out);
    if (judged.out == before) break;
    before = judged.out;
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (fitted[k] && !judged.out[k]) kept.push_back(rows[k]);
    if (static_cast<double>(kept.size()) < (1 - most) * static_cast<double>(split.fit.size())) {
      result.clustered = split.fit.size() - kept.size();
      result.x.assign(x.begin(), x.end());
      return result;
    }
    if (round == 0 && kept.size() == split.fit.size()) break;
    Problem good(program, plan, recordings, kept, groups, plain);
    if (program.settings.full_scale) good.divide_rows_by(fsr);
    good.set_noise_variance(all.noise_variance());
    std::vector<std::vector<double>> starts{result.x};
    if (round == 0) starts.push_back(good.start());
    const Refit better = refit(good, starts, {.seed = options.seed});
    if (!better.x.empty()) result.x = better.x;
  }
  result.scale = judged.scale;
  result.clustered = judged.clustered;
  const RecordedColumn* number_of = recordings.find("pose");
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!judged.out[k]) continue;
    Outlier o;
    o.row = rows[k];
    o.pose =
        static_cast<int>(number_of ? number_of->values[o.row] : static_cast<double>(o.row + 1));
    o.held_out = !fitted[k];
    o.sigmas = judged.distance[k] / (all.noise_known() ? 1 : judged.scale);
    o.beyond = judged.beyond[k];
    const auto off = residuals.raw.row(static_cast<Eigen::Index>(k));
    o.off.assign(off.begin(), off.end());
    o.statement = fmt::format("Pose {} is off by {} ({:.3g} sigmas).", o.pose,
                              size_of(o.off, program), o.sigmas);
    result.found.push_back(std::move(o));
  }
  result.statement = summary(result);
  return result;
}

}  // namespace talus
