#include "framework/calibration/dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace talus {

Groups::Groups(const Program& program, const Recordings& recordings) {
  for (std::size_t u = 0; u < program.unknowns.size(); ++u) {
    const Unknown& unknown = program.unknowns[u];
    if (unknown.per.empty()) {
      latent.push_back(static_cast<int>(u));
      continue;
    }
    Unknowns shared_by{static_cast<int>(u)};
    std::vector<const RecordedColumn*> columns;
    for (const std::string& name : unknown.per) {
      const RecordedColumn* column = recordings.find(name);
      if (!column) column = &recordings.get(name, number);  // explains what is missing
      columns.push_back(column);
    }
    std::map<std::vector<double>, int> known;
    for (std::size_t row = 0; row < recordings.rows(); ++row) {
      std::vector<double> key;
      std::string label;
      for (const RecordedColumn* c : columns) {
        if (std::isnan(c->values[row]))
          throw InputError(
              {recordings.file, recordings.lines[row], 0},
              fmt::format("column '{}' is empty", c->name),
              fmt::format("a value, since unknown '{}' is shared by its groups", unknown.name));
        key.push_back(c->values[row]);
        label += fmt::format("{}{}={:g}", label.empty() ? "" : ", ", c->name, c->values[row]);
      }
      auto [it, fresh] = known.emplace(key, shared_by.instances);
      if (fresh) ++shared_by.instances, shared_by.labels.push_back(label);
      shared_by.instance.push_back(it->second);
    }
    shared.push_back(std::move(shared_by));
  }
}

int Groups::total() const {
  return std::accumulate(shared.begin(), shared.end(), 0,
                         [](int n, const Unknowns& u) { return n + u.instances; });
}

Dataset::Dataset(const Program& program, const Plan& plan, const Recordings& recordings,
                 const std::vector<std::size_t>& rows, const Groups& groups) {
  // The recorded column behind each data slot.
  std::map<int, const RecordedColumn*> column_of;
  auto missing_column = [&](const std::string& name, Dimension dimension, const Place& place,
                            const char* what) {
    try {
      return &recordings.get(name, dimension);
    } catch (const InputError& e) {
      const std::string found = e.what(), before = to_string(e.place()) + ": ";
      throw InputError(e.place(),
                       found.substr(found.starts_with(before) ? before.size() : 0) +
                           fmt::format("\n  needed by {} at {}", what, to_string(place)));
    }
  };
  const std::set<int> needed(plan.data_slots().begin(), plan.data_slots().end());
  for (const Reading& r : program.readings)
    if (needed.contains(r.slot))
      column_of[r.slot] =
          missing_column(r.column, r.dimension, r.place,
                         r.covariate ? "an effect" : ("sensor '" + r.sensor + "'").c_str());
  for (const MeasuredColumn& c : program.columns)
    if (needed.contains(c.slot))
      column_of[c.slot] = missing_column(c.name, c.dimension, c.place, "a measured feature");

  // Order: by group instances, then as recorded.
  std::vector<std::size_t> order = rows;
  auto key = [&](std::size_t row) {
    std::vector<int> k;
    for (const auto& u : groups.shared) k.push_back(u.instance[row]);
    return k;
  };
  if (!groups.shared.empty())
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  for (std::size_t row : order) {
    if (batches_.empty() || batches_.back().count == lanes ||
        (!groups.shared.empty() && batches_.back().instance != key(row)))
      batches_.push_back({{}, 0, key(row)});
    batches_.back().poses.push_back(static_cast<int>(row));
    ++batches_.back().count;
  }
  for (Batch& b : batches_) b.poses.resize(lanes, b.poses[0]);
  poses_ = rows.size();

  // A complete value stands in for a missing one; the rows concerned are masked.
  std::map<int, double> stand_in;
  for (auto& [slot, column] : column_of) {
    auto it = std::find_if(column->values.begin(), column->values.end(),
                           [](double v) { return !std::isnan(v); });
    stand_in[slot] = it == column->values.end() ? 1 : *it;
  }
  const auto& nodes = plan.data_nodes();
  TapeValues values = plan.data_values();
  std::vector<double> slots(program.slots, 0);
  const int m = plan.rows();
  block_ = std::max<std::size_t>(1, nodes.size() * lanes);
  mask_block_ = static_cast<std::size_t>(m) * lanes;
  data_.assign(block_ * batches_.size(), 0);
  mask_.assign(mask_block_ * batches_.size(), 0);
  std::vector<std::vector<const RecordedColumn*>> row_columns(m);
  for (int r = 0; r < m; ++r)
    for (int slot : plan.row_slots(r))
      if (auto it = column_of.find(slot); it != column_of.end())
        row_columns[r].push_back(it->second);
  for (std::size_t b = 0; b < batches_.size(); ++b)
    for (int lane = 0; lane < lanes; ++lane) {
      const auto row = static_cast<std::size_t>(batches_[b].poses[lane]);
      for (auto& [slot, column] : column_of) {
        const double v = column->values[row];
        slots[slot] = std::isnan(v) ? stand_in[slot] : v;
      }
      const auto& value = values(slots);
      for (std::size_t i = 0; i < nodes.size(); ++i)
        data_[b * block_ + i * lanes + lane] = value[i];
      if (lane >= batches_[b].count) continue;
      for (int r = 0; r < m; ++r) {
        const bool whole =
            std::none_of(row_columns[r].begin(), row_columns[r].end(),
                         [&](const RecordedColumn* c) { return std::isnan(c->values[row]); });
        mask_[b * mask_block_ + static_cast<std::size_t>(r) * lanes + lane] = whole;
        ++(whole ? used_ : missing_);
      }
    }
}

}  // namespace talus
