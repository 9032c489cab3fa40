#include "framework/calibration/reach.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "framework/calibration/identifiability.h"
#include "framework/calibration/problem.h"

namespace talus {
namespace {

// The program with its readings as unknowns of their pose, as long as the object is there.
class ReadingsUnknown {
 public:
  explicit ReadingsUnknown(Program& program)
      : program_(program), readings_(program.readings), unknowns_(program.unknowns) {
    program.readings.clear();
    program.unknowns.clear();
    for (const Reading& r : readings_)
      program.unknowns.push_back({r.sensor, r.dimension, {}, {}, r.place, r.slot});
    for (Unknown u : unknowns_) {  // the model's own unknowns stay at their start
      u.per.clear();
      u.start.tolerance = 1e-9 * typical_size(u.start, u.dimension);
      program.unknowns.push_back(std::move(u));
    }
  }
  ~ReadingsUnknown() {
    program_.readings = readings_;
    program_.unknowns = unknowns_;
  }
  ReadingsUnknown(const ReadingsUnknown&) = delete;
  const std::vector<Reading>& readings() const { return readings_; }

 private:
  Program& program_;
  const std::vector<Reading> readings_;
  const std::vector<Unknown> unknowns_;
};

}  // namespace

std::size_t Reached::count(How which) const {
  return static_cast<std::size_t>(std::count(how.begin(), how.end(), which));
}

Reached reach(Program& program, const Recordings& recordings, int threads) {
  const ReadingsUnknown turned(program);
  const std::vector<Reading>& readings = turned.readings();
  std::vector<std::size_t> open(recordings.rows());  // poses not reached inside the ranges
  for (std::size_t k = 0; k < open.size(); ++k) open[k] = k;
  ProblemOptions options;
  options.threads = threads;
  options.only_unknowns = true;
  const Groups groups(program, recordings);
  const Plan plan = plan_for(program, groups, options);
  Reached result;
  result.readings.assign(open.size(), {});
  result.how.assign(open.size(), Reached::How::not_at_all);
  std::vector<double> best(open.size(), std::numeric_limits<double>::infinity());
  std::mt19937_64 random(1);
  for (int attempt = 0; attempt < 40 && !open.empty(); ++attempt) {
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const auto [low, high] = readings[i].range.value_or(std::pair(-90 * deg, 90 * deg));
      program.unknowns[i].start.value =
          attempt == 0 ? 0.5 * (low + high)
                       : std::uniform_real_distribution<double>(low, high)(random);
    }
    Problem problem(program, plan, recordings, open, groups, options);
    const Problem::Residuals r = problem.residuals({});
    for (std::size_t p = 0; p < open.size(); ++p) {
      const std::size_t k = open[p];
      const double left = r.whitened.row(static_cast<Eigen::Index>(p)).norm();
      bool inside = true;
      std::vector<double> pose;
      for (std::size_t i = 0; i < readings.size(); ++i) {
        double v = r.latent(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(i));
        if (readings[i].dimension == angle) v = std::remainder(v, 360 * deg);
        if (readings[i].range)
          inside &= v >= readings[i].range->first - 1e-9 && v <= readings[i].range->second + 1e-9;
        pose.push_back(v);
      }
      // Reached inside its ranges, reached, not reached.
      const double score = left < 1e-3 ? (inside ? 0 : 1) : 2 + left;
      if (!(score < best[k])) continue;
      best[k] = score, result.readings[k] = pose;
      result.how[k] = score == 0   ? Reached::How::inside
                      : score == 1 ? Reached::How::outside
                                   : Reached::How::not_at_all;
    }
    std::erase_if(open, [&](std::size_t k) { return best[k] == 0; });
  }
  return result;
}

}  // namespace talus
