#include "framework/diagnosis/tails.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {

namespace {

constexpr double tiny = 1e-300;
constexpr double precise = 1e-15;
constexpr int most = 100000;

// ln Q(a, x) of the regularised incomplete gamma function: series below, Legendre's continued
// fraction (Lentz's scheme) above.
double log_gamma_tail(double a, double x) {
  if (!(x > 0)) return 0;
  const double front = a * std::log(x) - x - std::lgamma(a);
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < most && term > precise * sum; ++n) sum += term *= x / (a + n);
    return std::log1p(-std::min(1.0, std::exp(front) * sum));
  }
  double b = x + 1 - a, c = 1 / tiny, d = 1 / b, h = d;
  for (int n = 1; n < most; ++n) {
    const double e = -n * (n - a);
    b += 2;
    d = 1 / (e * d + b);
    c = b + e / c;
    h *= d * c;
    if (std::abs(d * c - 1) < precise) break;
  }
  return front + std::log(h);
}

// The continued fraction of the incomplete beta function I_x(a, b), for x < (a + 1) / (a + b + 2).
double beta_fraction(double a, double b, double x) {
  double c = 1, d = 1 - (a + b) * x / (a + 1);
  d = 1 / (std::abs(d) < tiny ? tiny : d);
  double h = d;
  for (int n = 1; n < most; ++n) {
    for (const double e : {n * (b - n) * x / ((a + 2 * n - 1) * (a + 2 * n)),
                           -(a + n) * (a + b + n) * x / ((a + 2 * n) * (a + 2 * n + 1))}) {
      d = 1 + e * d;
      d = 1 / (std::abs(d) < tiny ? tiny : d);
      c = 1 + e / c;
      if (std::abs(c) < tiny) c = tiny;
      h *= d * c;
    }
    if (std::abs(d * c - 1) < precise) break;
  }
  return h;
}

// The root of a decreasing function of x > 0.
template <class F>
double root(F f) {
  double low = 0, high = 1;
  while (f(high) > 0 && high < 1e12) low = high, high *= 2;
  while (high - low > 1e-13 * high) {
    const double middle = low + (high - low) / 2;
    if (middle == low || middle == high) break;
    (f(middle) > 0 ? low : high) = middle;
  }
  return low + (high - low) / 2;
}

}  // namespace

double log_chi2_tail(double x, double freedom) {
  return freedom > 0 ? log_gamma_tail(freedom / 2, x / 2) : 0;
}

double log_f_tail(double f, double numerator, double denominator) {
  if (!(f > 0) || !(numerator > 0) || !(denominator > 0)) return 0;
  if (std::isinf(f)) return -std::numeric_limits<double>::infinity();
  const double a = denominator / 2, b = numerator / 2;
  const double x = denominator / (denominator + numerator * f);
  const double y = numerator * f / (denominator + numerator * f);
  const double front =
      std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log(y);
  if (x < (a + 1) / (a + b + 2)) return front + std::log(beta_fraction(a, b, x) / a);
  return std::log1p(-std::min(1.0, std::exp(front) * beta_fraction(b, a, y) / b));
}

double chi2_quantile(double log_tail, double freedom) {
  return root([&](double x) { return log_chi2_tail(x, freedom) - log_tail; });
}

double noncentral_chi2_tail(double x, double freedom, double noncentrality) {
  const double mean = noncentrality / 2;
  if (!(mean > 0)) return std::exp(log_chi2_tail(x, freedom));
  const int last = static_cast<int>(mean + 12 * std::sqrt(mean) + 40);
  const int first = std::max(0, static_cast<int>(mean - 12 * std::sqrt(mean)));
  double sum = 0;
  for (int j = first; j <= last; ++j)
    sum += std::exp(j * std::log(mean) - mean - std::lgamma(j + 1.0) +
                    log_chi2_tail(x, freedom + 2 * j));
  return std::min(1.0, sum);
}

double needed_noncentrality(double log_threshold, double freedom, double power) {
  const double x = chi2_quantile(log_threshold, freedom);
  return root([&](double lambda) { return power - noncentral_chi2_tail(x, freedom, lambda); });
}

}  // namespace talus
