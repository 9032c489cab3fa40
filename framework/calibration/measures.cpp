#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/calibration/fit.h"
#include "framework/kinematics/tape_values.h"

namespace talus {

std::vector<Measure> measures(const Program& program, const Eigen::MatrixXd& raw,
                              const std::vector<double>& fsr) {
  std::vector<Measure> result;
  for (std::size_t r = 0; r < program.rows.size(); ++r) {
    Measure m{program.rows[r].measure, program.rows[r].dimension};
    double sum = 0, squares = 0;
    for (Eigen::Index k = 0; k < raw.rows(); ++k) {
      const double e = raw(k, static_cast<Eigen::Index>(r));
      if (std::isnan(e)) continue;
      ++m.count, sum += e, squares += e * e;
    }
    const auto n = static_cast<double>(m.count);
    m.bias = m.count ? sum / n : std::numeric_limits<double>::quiet_NaN();
    m.rmse = m.count ? std::sqrt(squares / n) : m.bias;
    m.precision = m.count > 1 ? std::sqrt(std::max(0.0, (squares - n * m.bias * m.bias) / (n - 1)))
                              : std::numeric_limits<double>::quiet_NaN();
    m.fsr = fsr[r];
    m.percent_fsr = 100 * m.rmse / m.fsr;
    result.push_back(m);
  }
  return result;
}

namespace {

using Columns = std::vector<std::pair<int, const RecordedColumn*>>;

// Sets each feature's chain to the measured orientation whose entries are nearest to their mean.
void refer_to_middle(const Program& program, std::size_t rows, const Columns& data,
                     TapeValues& orientation, std::vector<double>& slots) {
  const std::size_t n = program.features.size();
  std::vector<double> mean(9 * n, 0), best(n, std::numeric_limits<double>::infinity());
  for (int pass = 0; pass < 2; ++pass)
    for (std::size_t k = 0; k < rows; ++k) {
      for (const auto& [slot, column] : data) slots[slot] = column->values[k];
      const auto& R = orientation(slots);
      for (std::size_t f = 0; f < n; ++f) {
        if (std::isnan(R[9 * f])) continue;
        double away = 0;
        for (std::size_t i = 9 * f; i < 9 * f + 9; ++i) {
          if (pass == 0) mean[i] += R[i] / static_cast<double>(rows);
          away += (R[i] - mean[i]) * (R[i] - mean[i]);
        }
        if (pass == 0 || away >= best[f]) continue;
        best[f] = away;
        for (std::size_t i = 0; i < 9; ++i)
          slots[program.chains[program.features[f].chain].first_slot + static_cast<int>(i)] =
              R[9 * f + i];
      }
    }
}

}  // namespace

// A row is measured minus modelled, so at a model pose that stands still it runs over the measured
// quantity. Lengths are taken at the identity; angles at the measured orientation nearest to the
// mean of all, so that they do not wrap.
std::vector<double> full_scale_ranges(const Program& program, const Recordings& recordings) {
  std::vector<std::int32_t> nodes, poses;
  Tape& tape = *program.tape;
  for (const Row& row : program.rows) nodes.push_back(row.value.node_on(tape));
  for (const Feature& f : program.features) {
    const Matrix3<Expr> R = f.observed.frame.rotation();
    for (int i = 0; i < 9; ++i) poses.push_back(R[i / 3][i % 3].node_on(tape));
  }
  TapeValues values(tape, nodes), orientation(tape, poses);
  std::vector<double> slots(program.slots, 0);
  for (const Parameter& p : program.parameters) slots[p.slot] = p.nominal.value;
  Columns data;
  for (const Reading& r : program.readings)
    if (const RecordedColumn* c = recordings.find(r.column)) data.emplace_back(r.slot, c);
  for (const MeasuredColumn& m : program.columns)
    if (const RecordedColumn* c = recordings.find(m.name)) data.emplace_back(m.slot, c);
  const std::size_t rows = program.rows.size();
  std::vector<double> low(rows, std::numeric_limits<double>::infinity()), high(rows, -low[0]);
  for (int pass = 0; pass < 2; ++pass) {  // lengths and numbers, then angles
    for (const Chain& c : program.chains)
      for (int i = 0; i < 12; ++i) slots[c.first_slot + i] = i == 0 || i == 4 || i == 8;
    if (pass == 1) refer_to_middle(program, recordings.rows(), data, orientation, slots);
    for (std::size_t k = 0; k < recordings.rows(); ++k) {
      for (auto& [slot, column] : data) slots[slot] = column->values[k];
      const auto& v = values(slots);
      for (std::size_t r = 0; r < rows; ++r)
        if (!std::isnan(v[r]) && (program.rows[r].dimension == angle) == (pass == 1))
          low[r] = std::min(low[r], v[r]), high[r] = std::max(high[r], v[r]);
    }
  }
  std::vector<double> range(rows);
  for (std::size_t r = 0; r < rows; ++r)
    range[r] = high[r] > low[r] ? high[r] - low[r] : std::numeric_limits<double>::quiet_NaN();
  return range;
}

}  // namespace talus
