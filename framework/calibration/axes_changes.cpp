#include "framework/calibration/axes_changes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

Dimension dimension_of(int variable) { return variable < 2 ? length : angle; }

// The angle by which rows are sorted into arcs: a column of that name, or a hinge's coordinate as
// it was fitted.
std::vector<double> arc_angles(const AxisFinder& finder, const Recordings& recordings,
                               const std::vector<std::size_t>& rows, const Located& located,
                               const std::string& by) {
  if (recordings.find(by)) {
    std::vector<double> angles;
    for (std::size_t row : rows) angles.push_back(recordings.get(by, angle).values[row]);
    return angles;
  }
  const auto column = located.coordinates.col(finder.hinge(by, {"--by " + by, 0, 0}));
  return {column.begin(), column.end()};
}

// Rows in which the frame was measured whole.
std::vector<std::size_t> measured_rows(const AxisFinder& finder, const Recordings& recordings) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < recordings.rows(); ++row) {
    bool whole = true;
    for (int c : finder.feature().columns)
      if (const RecordedColumn* column = recordings.find(finder.program().columns[c].name))
        whole &= !std::isnan(column->values[row]);
    if (whole) rows.push_back(row);
  }
  if (rows.size() < 3)
    throw InputError(
        {recordings.file, 0, 0},
        fmt::format("{} poses in which '{}' was measured", rows.size(), finder.feature().name),
        "three at the least");
  return rows;
}

void find_changes(ArcAxes& arc) {
  const Located& reference = arc.located[0];
  for (std::size_t r = 1; r < arc.located.size(); ++r) {
    auto& list = arc.changes.emplace_back();
    for (std::size_t k = 0; k < reference.axes.size(); ++k) {
      const LocatedAxis &before = reference.axes[k], &after = arc.located[r].axes[k];
      AxisChange change;
      for (std::size_t v = 0; v < 4; ++v) {
        change.value[v] = after.value[v] - before.value[v];
        change.std[v] = std::hypot(after.std[v], before.std[v]);
      }
      change.determined = before.determined && after.determined;
      list.push_back(change);
    }
  }
}

void judge(ArcAxes& arc, const std::vector<std::vector<const std::vector<double>*>>& truth) {
  for (std::size_t k = 0; k < truth.size(); ++k)
    for (std::size_t v = 0; v < 4; ++v) {
      if (!truth[k][v]) continue;
      ChangeErrors e{static_cast<int>(k), static_cast<int>(v)};
      double sum = 0, squares = 0;
      for (std::size_t r = 0; r < arc.changes.size(); ++r) {
        const double actual = (*truth[k][v])[r];
        if (!arc.changes[r][k].determined || std::isnan(actual)) continue;
        const double error = arc.changes[r][k].value[v] - actual;
        sum += error, squares += error * error, ++e.count;
      }
      if (e.count == 0) continue;  // no change was determined
      const auto n = static_cast<double>(e.count);
      e.bias = sum / n;
      e.rmse = std::sqrt(squares / n);
      e.precision =
          n > 1 ? std::sqrt(std::max(0.0, squares - n * e.bias * e.bias) / (n - 1)) : std::nan("");
      arc.errors.push_back(e);
    }
}

}  // namespace

std::vector<Arc> parse_arcs(const std::string& text, const UnitSystem& units) {
  std::vector<Arc> arcs;
  const Place place{"--arcs", 0, 0};
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    std::string word = text.substr(begin, end - begin);
    std::erase(word, ' ');
    const std::size_t colon = word.find(':');
    if (colon == std::string::npos)
      throw InputError(place, fmt::format("'{}'", word), "first:last, such as \"20:80, 30:90\"");
    Arc arc;
    arc.first = parse_quantity(word.substr(0, colon), angle, units, place).value;
    arc.last = parse_quantity(word.substr(colon + 1), angle, units, place).value;
    arc.name = word;
    if (!(arc.first < arc.last))
      throw InputError(place, fmt::format("'{}'", word), "first below last");
    arcs.push_back(arc);
    begin = end + 1;
  }
  return arcs;
}

std::string variable_name(const AxisFinder& finder, const AxesResult& result,
                          const AxisLabels& labels, int axis, int variable) {
  return finder.hinges()[axis].name + "." + labels.of(result.views[axis].main)[variable];
}

AxesResult find_axes(AxisFinder& finder, const std::vector<Recordings>& recordings,
                     const AxesOptions& options, const Recordings* actual) {
  AxesResult result;
  const std::string by = options.by.empty() ? finder.hinges()[0].name : options.by;
  const std::size_t files = recordings.size(), steps = files * (1 + options.arcs.size());
  std::size_t done = 0;
  auto locate = [&](const Recordings& table, const std::vector<std::size_t>& rows) {
    Located located = finder.locate(table, rows, options.locate);
    if (options.progress)
      options.progress(static_cast<double>(++done) / static_cast<double>(steps));
    return located;
  };

  std::vector<std::vector<std::size_t>> all(files);
  for (std::size_t r = 0; r < files; ++r) {
    all[r] = measured_rows(finder, recordings[r]);
    result.whole.located.push_back(locate(recordings[r], all[r]));
    if (r > 0) continue;
    Located& reference = result.whole.located[0];
    result.views = finder.body_views(reference);
    finder.describe(reference, result.views);
    if (options.anatomical) {
      std::vector<double> zero(finder.program().readings.size() + finder.program().unknowns.size(),
                               0);
      if (options.zero) {
        const auto at = std::find(all[0].begin(), all[0].end(), *options.zero);
        if (at == all[0].end())
          throw InputError({"--zero", 0, 0},
                           fmt::format("no row {} with a measured pose", *options.zero + 1),
                           fmt::format("1 to {}", recordings[0].rows()));
        zero = finder.pose(recordings[0], all[0], reference,
                           static_cast<std::size_t>(at - all[0].begin()));
      }
      result.views = finder.anatomical_views(reference, by, zero, {"--frames anatomical", 0, 0});
    }
  }
  for (Located& located : result.whole.located) finder.describe(located, result.views);
  find_changes(result.whole);

  for (const Arc& arc : options.arcs) {
    ArcAxes& each = result.arcs.emplace_back();
    each.arc = arc;
    for (std::size_t r = 0; r < files; ++r) {
      const std::vector<double> angles =
          arc_angles(finder, recordings[r], all[r], result.whole.located[r], by);
      std::vector<std::size_t> rows;
      for (std::size_t k = 0; k < all[r].size(); ++k)
        if (angles[k] >= arc.first - 1e-9 && angles[k] <= arc.last + 1e-9)
          rows.push_back(all[r][k]);
      if (rows.size() < 3)
        throw InputError({recordings[r].file, 0, 0},
                         fmt::format("{} poses with '{}' in the arc {}", rows.size(), by, arc.name),
                         "three at the least");
      each.located.push_back(locate(recordings[r], rows));
      finder.describe(each.located.back(), result.views);
    }
    find_changes(each);
  }

  if (actual) {
    if (actual->rows() + 1 != files)
      throw InputError({actual->file, 0, 0}, fmt::format("{} rows", actual->rows()),
                       fmt::format("{}: one per recording after the first", files - 1));
    std::vector<std::vector<const std::vector<double>*>> truth(
        finder.hinges().size(), std::vector<const std::vector<double>*>(4, nullptr));
    std::vector<std::string> names;
    bool any = false;
    for (std::size_t k = 0; k < truth.size(); ++k)
      for (int v = 0; v < 4; ++v) {
        names.push_back(variable_name(finder, result, options.labels, static_cast<int>(k), v));
        if (!actual->find(names.back())) continue;
        truth[k][v] = &actual->get(names.back(), dimension_of(v)).values;
        any = true;
      }
    // A misspelt variable must not pass for one that is not judged.
    for (const RecordedColumn& column : actual->columns)
      if (column.name.find('.') != std::string::npos &&
          std::find(names.begin(), names.end(), column.name) == names.end())
        throw InputError(column.place, fmt::format("no variable '{}'", column.name),
                         "one of: " + join(names), nearest(column.name, names));
    if (!any)
      throw InputError({actual->file, actual->header_line, 0}, "no column of a true change",
                       "one of: " + join(names));
    judge(result.whole, truth);
    for (ArcAxes& arc : result.arcs) judge(arc, truth);
    for (std::size_t e = 0; e < result.whole.errors.size(); ++e) {
      AxesResult::Worst worst{-1, result.whole.errors[e]};
      for (std::size_t a = 0; a < result.arcs.size(); ++a) {
        const ChangeErrors& here = result.arcs[a].errors[e];
        if (a == 0 || here.rmse > worst.errors.rmse) worst = {static_cast<int>(a), here};
      }
      result.worst.push_back(worst);
    }
  }
  return result;
}

}  // namespace talus
