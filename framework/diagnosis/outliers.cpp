#include "framework/diagnosis/outliers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "framework/calibration/fit.h"
#include "framework/diagnosis/neighbours.h"
#include "framework/diagnosis/pose_blocks.h"
#include "framework/diagnosis/refit.h"
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
// More poses than this are no blunders but a group of their own.
constexpr double most = 0.15;
// Least trimmed squares goes by this share of the poses; the others may be anything.
constexpr double trusted = 0.75;
// With one pose in ten bad, a draw of twelve is clean one time in four.
constexpr int draws = 200, few_draws = 40, concentrations = 2, finalists = 5, rounds = 5;

struct Judged {
  std::vector<bool> out;
  std::vector<double> distance, beyond;
  double scale = 1;
  std::size_t clustered = 0;
  PoseBlocks::Solution solution;
};

class Search {
 public:
  // `fitted`: the poses that may be fitted; the others are judged alone.
  Search(const PoseBlocks& blocks, const std::vector<bool>& fitted, const Neighbours& neighbours,
         bool noise_known, std::uint64_t seed)
      : blocks_(blocks),
        fitted_(fitted),
        neighbours_(neighbours),
        noise_known_(noise_known),
        random_(seed) {
    std::map<double, double> middle, decile;
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

  // From a first guess of the good poses to a choice that judges itself the same.
  Judged settle(std::vector<bool> in) {
    Judged judged;
    for (int i = 0; i < 3 * rounds; ++i) {
      judged = judge(in);
      std::vector<bool> next = fitted_;
      for (int k : own_) next[k] = !judged.out[k];
      if (next == in) break;
      in = std::move(next);
    }
    return judged;
  }

  Judged judge(const std::vector<bool>& in) const;
  std::vector<bool> least_trimmed();

 private:
  double trimmed(const PoseBlocks::Solution& solution, std::vector<bool>& best) const;

  const PoseBlocks& blocks_;
  const std::vector<bool>& fitted_;
  std::vector<int> own_;  // numbers of those to fit
  const Neighbours& neighbours_;
  const bool noise_known_;
  std::mt19937_64 random_;
  std::map<double, double> middle_, decile_, limit_;
};

// The sum of squares per degree of freedom of the trusted share that fits best, and which those
// are.
double Search::trimmed(const PoseBlocks::Solution& solution, std::vector<bool>& best) const {
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

std::vector<bool> Search::least_trimmed() {
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

Judged Search::judge(const std::vector<bool>& in) const {
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
    Search search(blocks, fitted, neighbours, all.noise_known(), options.seed);
    judged = search.settle(search.least_trimmed());
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
