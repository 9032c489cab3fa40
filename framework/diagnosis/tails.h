// Tails of the distributions that tests are judged by, as natural logarithms: accurate where the
// probability itself would be zero in floating point.
#pragma once

namespace talus {

double log_chi2_tail(double x, double freedom);  // ln P(chi2 > x)
// ln P(F > f) of the ratio of mean squares with these degrees of freedom.
double log_f_tail(double f, double numerator, double denominator);
double chi2_quantile(double log_tail, double freedom);  // x with ln P(chi2 > x) = log_tail
// P(chi2' > x) of the noncentral distribution.
double noncentral_chi2_tail(double x, double freedom, double noncentrality);
// The noncentrality that exceeds the threshold (as log p) with the given probability.
double needed_noncentrality(double log_threshold, double freedom, double power);

}  // namespace talus
