#include "framework/kinematics/covariates.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

constexpr double kAtRest = 1;  // s between rows from which on the linkage stands still at each
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::vector<double> values_of(const Recordings& r, std::string_view name, double otherwise) {
  const RecordedColumn* c = r.find(name);
  return c ? c->values : std::vector<double>(r.rows(), otherwise);
}

// Derivative at the middle of three points, or of two at an end.
std::vector<double> rates(const std::vector<double>& v, const std::vector<double>& t,
                          const std::vector<double>& session) {
  const std::size_t n = v.size();
  std::vector<double> result(n, 0);
  auto near = [&](std::size_t a, std::size_t b) {
    return !(session[a] != session[b]) && t[b] > t[a] && t[b] - t[a] <= kAtRest &&
           !std::isnan(v[a]) && !std::isnan(v[b]);
  };
  for (std::size_t k = 0; k < n; ++k) {
    const bool before = k > 0 && near(k - 1, k), after = k + 1 < n && near(k, k + 1);
    const double b = before ? t[k] - t[k - 1] : 0, a = after ? t[k + 1] - t[k] : 0;
    const double slope_b = before ? (v[k] - v[k - 1]) / b : 0,
                 slope_a = after ? (v[k + 1] - v[k]) / a : 0;
    if (before && after)
      result[k] = (slope_b * a + slope_a * b) / (a + b);
    else
      result[k] = slope_a + slope_b;
    if (std::isnan(v[k])) result[k] = kNone;
  }
  return result;
}

std::vector<double> travels(const std::vector<double>& v, const std::vector<double>& session) {
  std::vector<double> result(v.size(), 0);
  double last = 0;
  for (std::size_t k = 1; k < v.size(); ++k) {
    if (session[k] != session[k - 1]) {
      last = 0;
      continue;
    }
    const double step = v[k] - v[k - 1];
    result[k] = std::abs(step) + (step * last > 0 ? result[k - 1] : 0);
    if (step != 0) last = step;
  }
  return result;
}

std::vector<double> since(const std::vector<double>& t, const std::vector<double>& session) {
  std::vector<double> result(t.size(), 0);
  double start = t.empty() ? 0 : t[0];
  for (std::size_t k = 0; k < t.size(); ++k) {
    if (k > 0 && session[k] != session[k - 1]) start = t[k];
    result[k] = t[k] - start;
  }
  return result;
}

}  // namespace

bool is_derived(std::string_view column) {
  return column == "since" || column.starts_with("rate:") || column.starts_with("travel:") ||
         column.starts_with("load:");
}

double usual_value(std::string_view covariate) {
  return covariate == "temperature" ? 20 : covariate == "session" || covariate == "pose" ? 1 : 0;
}

Recordings with_covariates(const Program& program, Recordings recordings) {
  const std::vector<double> session = values_of(recordings, "session", 1);
  for (const Reading& r : program.readings) {
    if (!r.covariate || recordings.find(r.column)) continue;
    RecordedColumn column{r.column, UnitSystem{}.of(r.dimension), {}, {}};
    const std::size_t colon = r.column.find(':');
    const std::string kind = r.column.substr(0, colon),
                      of = colon == std::string::npos ? "" : r.column.substr(colon + 1);
    if (kind == "pose") {
      for (std::size_t k = 0; k < recordings.rows(); ++k)
        column.values.push_back(static_cast<double>(k + 1));
    } else if (kind == "since" && recordings.find("time")) {
      column.values = since(values_of(recordings, "time", 0), session);
    } else if (kind == "rate" && recordings.find("time") && recordings.find(of)) {
      column.values = rates(recordings.find(of)->values, recordings.find("time")->values, session);
    } else if (kind == "travel" && recordings.find(of)) {
      column.values = travels(recordings.find(of)->values, session);
    } else {
      continue;
    }
    recordings.columns.push_back(std::move(column));
  }
  return recordings;
}

}  // namespace talus
