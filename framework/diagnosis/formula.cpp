#include "framework/diagnosis/formula.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/diagnosis/tails.h"

namespace talus {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kLoose = 100;                       // amounts may be so many usual sizes
constexpr double kLocal = 4;                         // poses that must carry a function
constexpr int kFirst = 4, kSecond = 5, kMinima = 3;  // how many are followed up

// A point of a shape's grid.
struct Point {
  std::vector<double> settings;
  MatrixXd phi, A;
  VectorXd b;
  double chi2 = kInfinite;
};

struct Scanned {
  const Shape* shape;
  ShapeValues values;
  std::vector<std::vector<double>> tries;  // of each setting
  std::vector<Point> points;               // the last setting varies fastest
  double variants = 1;                     // of whole numbers
};

class Regression {
 public:
  explicit Regression(const CurveEvidence& e) : e_(e) {}

  FormulaChoice run() {
    noise();
    for (const Shape& shape : formula_shapes())
      if (suits(shape, e_.of, e_.x)) scan(shape);
    singles();
    pairs();
    std::stable_sort(fits_.begin(), fits_.end(),
                     [](const FormulaFit& a, const FormulaFit& b) { return a.bic < b.bic; });
    choose();
    return std::move(out_);
  }

 private:
  MatrixXd weighed(const MatrixXd& phi) const { return talus::weighed(e_, phi); }

  // The noise is what the best of the free curves leaves, where it is not known or that is more.
  void noise() {
    std::vector<std::pair<double, int>> curves;  // chi-square, directions
    double left = e_.chi2 / std::max(1.0, e_.freedom);
    for (const MatrixXd& curve : e_.curves) {
      const auto [gain, seen] = curve_gain(e_, curve);
      curves.emplace_back(e_.chi2 - gain, seen);
      left = std::min(left, (e_.chi2 - gain) / std::max(1.0, e_.freedom - seen));
    }
    out_.noise = e_.noise_known ? std::max(1.0, left) : left;
    out_.curve_chi2 = out_.curve_bic = e_.chi2 / out_.noise;
    for (const auto& [chi2, seen] : curves)
      if (const double bic = chi2 / out_.noise + seen * std::log(e_.rows); bic < out_.curve_bic)
        out_.curve_bic = bic, out_.curve_chi2 = chi2 / out_.noise, out_.curve_parameters = seen;
  }

  // Amounts and chi-square (in units of the noise) of given functions.
  double solve(const MatrixXd& A, const VectorXd& b, const VectorXd& largest,
               VectorXd* amounts = nullptr) const {
    const VectorXd D = kLoose * e_.typical * largest.cwiseInverse();
    MatrixXd H = D.asDiagonal() * A * D.asDiagonal();
    H.diagonal().array() += 1;
    const VectorXd c = D.asDiagonal() * b;
    const VectorXd y = H.ldlt().solve(c);
    if (amounts) *amounts = D.asDiagonal() * y;
    return (e_.chi2 - c.dot(y)) / out_.noise;
  }

  // Fewer poses than that carry it (its mean apart): it would follow single poses.
  bool local(const MatrixXd& phi) const {
    for (Index j = 0; j < phi.cols(); ++j) {
      const VectorXd centred = phi.col(j).array() - phi.col(j).mean();
      const double most = centred.cwiseAbs2().maxCoeff();
      if (!(most > 0) || centred.squaredNorm() < kLocal * most) return true;
    }
    return false;
  }

  static VectorXd largest(const MatrixXd& phi) {
    return phi.cwiseAbs().colwise().maxCoeff().transpose();
  }

  void evaluate(const Scanned& s, Point& p) const {
    p.phi = s.values(e_.x, p.settings);
    p.chi2 = kInfinite;
    if (local(p.phi)) return;
    const MatrixXd K = weighed(p.phi);
    p.A = p.phi.transpose() * K;
    for (Index j = 0; j < p.A.cols(); ++j)  // the geometry takes up all of it
      if (p.A(j, j) < 1e-8 * e_.weight.dot(p.phi.col(j).cwiseAbs2())) return;
    p.b = p.phi.transpose() * e_.wanted;
    p.chi2 = solve(p.A, p.b, largest(p.phi));
  }

  void scan(const Shape& shape) {
    Scanned s{&shape, ShapeValues(shape), {}, {}};
    std::vector<double> sorted(e_.x.begin(), e_.x.end());
    std::sort(sorted.begin(), sorted.end());
    std::size_t count = 1;
    for (const ShapeSetting& setting : shape.settings) {
      s.tries.push_back(tries(setting, e_.of, sorted));
      count *= s.tries.back().size();
      if (setting.kind == ShapeSetting::Kind::whole)
        s.variants = std::max(1.0, static_cast<double>(s.tries.back().size()));
    }
    for (std::size_t i = 0; i < count; ++i) {
      Point p;
      std::size_t rest = i;
      p.settings.resize(s.tries.size());
      for (std::size_t k = s.tries.size(); k-- > 0;) {
        p.settings[k] = s.tries[k][rest % s.tries[k].size()];
        rest /= s.tries[k].size();
      }
      evaluate(s, p);
      s.points.push_back(std::move(p));
    }
    if (!s.points.empty()) scanned_.push_back(std::move(s));
  }

  // Points that no neighbour on the grid is better than; the best first. Of whole numbers, all.
  static std::vector<std::size_t> minima(const Scanned& s, const std::vector<double>& chi2) {
    std::vector<std::size_t> result;
    for (std::size_t i = 0; i < chi2.size(); ++i) {
      if (!std::isfinite(chi2[i])) continue;
      bool least = true;
      std::size_t stride = 1;
      for (std::size_t k = s.tries.size(); k-- > 0; stride *= s.tries[k].size()) {
        const std::size_t size = s.tries[k].size(), at = i / stride % size;
        if (s.variants > 1) continue;
        if (at > 0 && chi2[i - stride] < chi2[i]) least = false;
        if (at + 1 < size && chi2[i + stride] < chi2[i]) least = false;
      }
      if (least) result.push_back(i);
    }
    std::stable_sort(result.begin(), result.end(),
                     [&](std::size_t a, std::size_t b) { return chi2[a] < chi2[b]; });
    if (result.size() > kMinima) result.resize(kMinima);
    return result;
  }

  struct Part {
    const Scanned* scanned;
    std::vector<double> settings;
  };

  double chi2_of(const std::vector<Part>& parts, FormulaFit* fit = nullptr) const {
    std::vector<Point> points;
    Index columns = 0;
    for (const Part& part : parts) {
      Point p;
      p.settings = part.settings;
      evaluate(*part.scanned, p);
      if (!std::isfinite(p.chi2)) return kInfinite;
      columns += p.phi.cols();
      points.push_back(std::move(p));
    }
    MatrixXd phi(e_.x.size(), columns);
    columns = 0;
    for (const Point& p : points)
      phi.middleCols(columns, p.phi.cols()) = p.phi, columns += p.phi.cols();
    VectorXd amounts;
    const double chi2 =
        solve(phi.transpose() * weighed(phi), phi.transpose() * e_.wanted, largest(phi), &amounts);
    if (fit) fit->chi2 = chi2, fit->amounts = amounts, fit->signal = phi * amounts;
    return chi2;
  }

  // Steps to either side of each setting, halved where none helps.
  void polish(std::vector<Part>& parts, bool& edge) const {
    double best = chi2_of(parts);
    edge = false;
    for (std::size_t round = 0; round < 12; ++round) {
      const double share = std::pow(0.5, static_cast<double>(round + 1));
      for (bool better = true; better;) {
        better = false;
        for (Part& part : parts)
          for (std::size_t k = 0; k < part.settings.size(); ++k) {
            if (!part.scanned->shape->settings[k].fitted()) continue;
            for (const double sense : {-1.0, 1.0}) {
              const double before = part.settings[k];
              part.settings[k] = moved(part.scanned->shape->settings[k], part.scanned->tries[k],
                                       before, sense * share);
              const double chi2 = chi2_of(parts);
              if (chi2 < best - 1e-6)
                best = chi2, better = true;
              else
                part.settings[k] = before;
            }
          }
      }
    }
    for (const Part& part : parts)
      for (std::size_t k = 0; k < part.settings.size(); ++k)
        if (part.scanned->shape->settings[k].fitted())
          edge |=
              at_edge(part.scanned->shape->settings[k], part.scanned->tries[k], part.settings[k]);
  }

  // By a share of the spacing of the tries there, staying within them. A scale is of either sense
  // and not near zero.
  static double moved(const ShapeSetting& setting, const std::vector<double>& tries, double value,
                      double share) {
    auto above = std::upper_bound(tries.begin(), tries.end(), value);
    if (above == tries.end()) --above;
    if (above == tries.begin()) ++above;
    const double high = *above, low = *(above - 1);
    const double next = value + share * (high - low);
    if (next < tries.front() || next > tries.back()) return value;
    if (setting.kind == ShapeSetting::Kind::scale &&
        ((low < 0 && high > 0) || (next < 0) != (value < 0)))
      return value;
    return next;
  }

  static bool at_edge(const ShapeSetting& setting, const std::vector<double>& tries, double value) {
    auto near = [&](double end, double beside) {
      return std::abs(value - end) <= 0.1 * std::abs(beside - end);
    };
    const std::size_t n = tries.size();
    if (n < 2) return false;
    if (near(tries[0], tries[1]) || near(tries[n - 1], tries[n - 2])) return true;
    if (setting.kind != ShapeSetting::Kind::scale) return false;
    const std::size_t half = n / 2;  // as many of either sense
    return near(tries[half - 1], tries[half - 2]) || near(tries[half], tries[half + 1]);
  }

  double penalty(const std::vector<Part>& parts, int& parameters) const {
    double extra = 0;
    parameters = 0;
    for (const Part& part : parts) {
      const Shape& shape = *part.scanned->shape;
      parameters += static_cast<int>(shape.amounts.size());
      for (const ShapeSetting& s : shape.settings)
        parameters += s.free() && s.kind != ShapeSetting::Kind::whole;
      extra += 2 * std::log(part.scanned->variants);
    }
    if (parts.size() > 1) extra += 2 * std::log(static_cast<double>(scanned_.size()));
    return parameters * std::log(e_.rows) + extra;
  }

  void add(std::vector<Part> parts) {
    FormulaFit fit;
    polish(parts, fit.edge);
    if (!std::isfinite(chi2_of(parts, &fit))) return;
    for (const Part& part : parts) fit.terms.push_back({part.scanned->shape, part.settings});
    fit.bic = fit.chi2 + penalty(parts, fit.parameters);
    for (const FormulaFit& known : fits_)
      if (same_shapes(known, fit) && distance2(known, fit) < 0.1) return;
    fits_.push_back(std::move(fit));
    parts_.push_back(std::move(parts));
  }

  static bool same_shapes(const FormulaFit& a, const FormulaFit& b) {
    if (a.terms.size() != b.terms.size()) return false;
    std::vector<std::string> first, second;
    for (const FormulaTerm& t : a.terms) first.push_back(t.shape->name);
    for (const FormulaTerm& t : b.terms) second.push_back(t.shape->name);
    std::sort(first.begin(), first.end()), std::sort(second.begin(), second.end());
    return first == second;
  }

  double distance2(const FormulaFit& a, const FormulaFit& b) const {
    const VectorXd d = a.signal - b.signal;
    return d.dot(weighed(d).col(0)) / out_.noise;
  }

  void singles() {
    for (const Scanned& s : scanned_) {
      std::vector<double> chi2;
      for (const Point& p : s.points) chi2.push_back(p.chi2);
      for (const std::size_t i : minima(s, chi2)) add({{&s, s.points[i].settings}});
    }
  }

  static bool varies(const Shape& shape) {
    return std::any_of(shape.settings.begin(), shape.settings.end(),
                       [](const ShapeSetting& s) { return s.free(); });
  }

  // A second shape beside each of the best.
  void pairs() {
    std::vector<std::size_t> order(fits_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return fits_[a].bic < fits_[b].bic; });
    std::vector<const Scanned*> done;
    std::vector<std::vector<Part>> firsts;
    for (const std::size_t i : order) {
      const std::vector<Part>& parts = parts_[i];
      if (std::find(done.begin(), done.end(), parts[0].scanned) != done.end()) continue;
      done.push_back(parts[0].scanned);
      firsts.push_back(parts);
      if (done.size() == kFirst) break;
    }
    for (const std::vector<Part>& first : firsts) {
      struct Second {
        std::vector<Part> parts;
        double bic;
      };
      std::vector<Second> seconds;
      Point one;
      one.settings = first[0].settings;
      evaluate(*first[0].scanned, one);
      if (!std::isfinite(one.chi2)) continue;
      for (const Scanned& s : scanned_) {
        if (&s == first[0].scanned && !varies(*s.shape)) continue;  // the same once more
        const std::vector<double> chi2 = beside(one, s);
        const auto best = std::min_element(chi2.begin(), chi2.end());
        if (!std::isfinite(*best)) continue;
        std::vector<Part> parts = first;
        parts.push_back({&s, s.points[static_cast<std::size_t>(best - chi2.begin())].settings});
        int ignored = 0;
        const double bic = *best + penalty(parts, ignored);
        seconds.push_back({std::move(parts), bic});
      }
      std::stable_sort(seconds.begin(), seconds.end(),
                       [](const Second& a, const Second& b) { return a.bic < b.bic; });
      for (std::size_t i = 0; i < seconds.size() && i < kSecond; ++i) add(seconds[i].parts);
    }
  }

  // Chi-square of each point of a shape's grid beside a given one.
  std::vector<double> beside(const Point& one, const Scanned& s) const {
    const MatrixXd K = weighed(one.phi);
    std::vector<double> chi2;
    for (const Point& p : s.points) {
      chi2.push_back(kInfinite);
      if (!std::isfinite(p.chi2)) continue;
      const Index a = one.phi.cols(), b = p.phi.cols();
      MatrixXd A(a + b, a + b);
      A.topLeftCorner(a, a) = one.A, A.bottomRightCorner(b, b) = p.A;
      A.topRightCorner(a, b) = K.transpose() * p.phi;
      A.bottomLeftCorner(b, a) = A.topRightCorner(a, b).transpose();
      VectorXd rhs(a + b), most(a + b);
      rhs << one.b, p.b;
      most << largest(one.phi), largest(p.phi);
      chi2.back() = solve(A, rhs, most);
    }
    return chi2;
  }

  static bool jumps(const FormulaFit& f) {
    const auto& settings = f.terms[0].shape->settings;
    return settings.size() == 1 && settings[0].kind == ShapeSetting::Kind::split;
  }

  // Is `big` the formula `small` with more to it?
  bool contains(const FormulaFit& big, const FormulaFit& small) const {
    std::vector<bool> used(big.terms.size(), false);
    for (const FormulaTerm& t : small.terms) {
      bool found = false;
      for (std::size_t i = 0; i < big.terms.size() && !found; ++i) {
        const std::string& name = big.terms[i].shape->name;
        if (!used[i] && (name == t.shape->name || name == t.shape->special)) used[i] = found = true;
      }
      if (!found) return false;
    }
    // Of a jump the place is uncertain by some poses: that is no other formula.
    if (big.terms.size() == 1 && small.terms.size() == 1 && same_shapes(big, small) && jumps(small))
      return true;
    return distance2(big, small) <= 1.5 * std::max(0.0, small.chi2 - big.chi2) + 1;
  }

  double beside_p(const FormulaFit& fit) const {
    MatrixXd phi(e_.x.size(), fit.amounts.size());
    Index at = 0;
    for (const FormulaTerm& t : fit.terms)
      for (const Scanned& s : scanned_)
        if (s.shape == t.shape) {
          const MatrixXd own = s.values(e_.x, t.settings);
          phi.middleCols(at, own.cols()) = own, at += own.cols();
        }
    double least = 1;
    for (const MatrixXd& curve : e_.curves) {
      const auto [gain, seen] = curve_gain(e_, curve, &phi);
      if (seen > 0)
        least = std::min(least, std::exp(log_chi2_tail(std::max(0.0, gain / out_.noise), seen)));
    }
    return std::min(1.0, least * static_cast<double>(e_.curves.size()));
  }

  void choose() {
    std::vector<FormulaFit> all;
    for (FormulaFit& f : fits_)
      if (!f.edge) all.push_back(std::move(f));
    if (all.empty()) return;
    // The simplest that is not clearly worse than what it is part of, and leaves nothing.
    std::size_t chosen = 0;
    for (std::size_t i = 1; i < all.size(); ++i)
      if (all[i].bic - all[chosen].bic < 2 * std::log(kFormulaOdds) &&
          (all[i].parameters < all[chosen].parameters ||
           all[i].terms.size() < all[chosen].terms.size()) &&
          contains(all[chosen], all[i]) && beside_p(all[i]) >= kFormulaBeside)
        chosen = i;
    out_.ranked.push_back(all[chosen]);
    for (std::size_t i = 0; i < all.size(); ++i)
      if (i != chosen && !contains(all[i], all[chosen])) out_.ranked.push_back(all[i]);
    const FormulaFit& best = out_.ranked[0];
    out_.odds = out_.ranked.size() > 1
                    ? std::exp(std::min(700.0, (out_.ranked[1].bic - best.bic) / 2))
                    : kInfinite;
    out_.beside_p = beside_p(best);
    using Outcome = FormulaChoice::Outcome;
    out_.outcome = out_.beside_p < kFormulaBeside ? Outcome::misfit
                   : best.bic > out_.curve_bic    ? Outcome::curve
                   : !(out_.odds > kFormulaOdds)  ? Outcome::rivals
                                                  : Outcome::wins;
  }

  const CurveEvidence& e_;
  std::vector<Scanned> scanned_;
  std::vector<FormulaFit> fits_;
  std::vector<std::vector<Part>> parts_;
  FormulaChoice out_;
};

}  // namespace

FormulaChoice choose_formula(const CurveEvidence& evidence) { return Regression(evidence).run(); }

}  // namespace talus
