#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "framework/diagnosis/blind_spots.h"
#include "framework/report/diagnosis_report.h"
#include "framework/report/layout.h"

namespace talus {
namespace {

constexpr double kImplausible = 10;  // times the usual size: as good as unseen
constexpr std::size_t kMost = 3, kLeast = 4;

std::string three(double v) { return std::isfinite(v) ? fmt::format("{:.3g}", v) : "-"; }

// "joint1, joint2, joint5" as "joint1, 2, 5".
std::string shortened(const std::vector<std::string>& names) {
  auto stem = [](const std::string& name) {
    return name.substr(0, name.find_last_not_of("0123456789") + 1);
  };
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string head = stem(names[i]);
    const bool more = i > 0 && head == stem(names[i - 1]) && head.size() < names[i].size();
    out += (i > 0 ? ", " : "") + (more ? names[i].substr(head.size()) : names[i]);
  }
  return out;
}

std::string rival_of(const SeenSuspect& s) {
  return s.rival.empty() || s.rival == "unknown" || s.imitates < 0.5
             ? "-"
             : fmt::format("{} at {} ({:.0f} %)", spoken(s.rival), s.rival_location,
                           100 * s.imitates);
}

std::string sensitivity_rows(const std::vector<const SeenSuspect*>& rows) {
  Table table({"<effect", "<at", ".smallest", ".usual", "<unit", "<would be taken for"});
  for (const auto* s : rows)
    table.row({spoken(s->effect), s->location, three(s->smallest), three(s->typical), s->unit,
               rival_of(*s)});
  return table.text();
}

}  // namespace

std::string evidence_table(const Diagnosis& d) {
  const bool held = !fit_before(d).measures_check.empty();
  const std::vector<Measure>&before =
            held ? fit_before(d).measures_check : fit_before(d).measures_fit,
        &after = held ? d.after.measures_check : d.after.measures_fit;
  Table table({"<measure", "<unit", ".RMSE before", ".RMSE after"});
  for (std::size_t i = 0; i < before.size() && i < after.size(); ++i) {
    const Unit unit = d.program->units.of(before[i].dimension);
    table.row({before[i].name, unit.text, figure(before[i].rmse / unit.factor),
               figure(after[i].rmse / unit.factor)});
  }
  return table.text();
}

std::string moved_parameters(const Diagnosis& d, std::size_t most) {
  struct Moved {
    const FittedValue *before, *after;
    double sigmas;
  };
  std::map<std::string, const FittedValue*> later;
  for (const FittedValue& v : d.after.parameters) later[v.name] = &v;
  std::vector<Moved> moved;
  for (const FittedValue& v : fit_before(d).parameters)
    if (const auto it = later.find(v.name);
        it != later.end() && std::isfinite(v.std) && v.std > 0) {
      const double sigmas = std::abs(it->second->value - v.value) / v.std;
      if (sigmas >= 1) moved.push_back({&v, it->second, sigmas});
    }
  if (moved.empty()) return "  none by more than its uncertainty\n";
  std::stable_sort(moved.begin(), moved.end(),
                   [](const Moved& a, const Moved& b) { return a.sigmas > b.sigmas; });
  Table table({"<parameter", ".before", ".after", "<unit", ".in uncertainties"});
  for (std::size_t i = 0; i < std::min(most, moved.size()); ++i) {
    const FittedValue &before = *moved[i].before, &after = *moved[i].after;
    const Unit unit = d.program->units.of(before.dimension);
    const int decimals = decimals_for(before.std / unit.factor);
    table.row({before.name, fixed(before.value / unit.factor, decimals),
               fixed(after.value / unit.factor, decimals), unit.text,
               fmt::format("{:.1f}", moved[i].sigmas)});
  }
  std::string out = table.text();
  if (moved.size() > most) out += fmt::format("  ... and {} more\n", moved.size() - most);
  return out;
}

std::string sensitivity_table(const Seen& seen, bool all) {
  std::vector<const SeenSuspect*> sorted;
  for (const SeenSuspect& s : seen.suspects)
    if (all || !s.unknown()) sorted.push_back(&s);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto* a, const auto* b) { return a->in_typical() < b->in_typical(); });
  if (all) return sensitivity_rows(sorted);
  // One location of each effect: where it shows best, where it shows least.
  std::vector<const SeenSuspect*> most, least;
  std::set<std::string> named;
  for (const auto* s : sorted)
    if (most.size() < kMost && s->in_typical() <= 1 && named.insert(s->effect).second)
      most.push_back(s);
  named.clear();
  std::map<std::string, std::vector<std::string>> unseen;
  for (auto it = sorted.rbegin(); it != sorted.rend(); ++it) {
    const SeenSuspect& s = **it;
    if (!(s.in_typical() <= kImplausible))
      unseen[spoken(s.effect)].insert(unseen[spoken(s.effect)].begin(), s.location);
    else if (least.size() < kLeast && s.in_typical() > 1 && named.insert(s.effect).second)
      least.push_back(&s);
  }
  std::string out;
  if (!most.empty()) out += "  best seen\n" + sensitivity_rows(most);
  if (!least.empty()) out += "  hardly seen at their usual size\n" + sensitivity_rows(least);
  if (!unseen.empty()) {
    std::vector<std::string> words;
    for (auto& [effect, at] : unseen) {
      std::sort(at.begin(), at.end());
      words.push_back(effect + " at " + shortened(at));
    }
    out += "  not seen at ten times their usual size: " + join(words, "; ") + "\n";
  }
  return out;
}

// Senses of approach are one column of signs, joint by joint.
std::string next_table(const NextRecordings& next, const UnitSystem& units, bool purposes) {
  std::vector<std::string> headings{">pose"}, signs(next.poses.size());
  std::vector<std::vector<std::string>> rows;
  for (std::size_t k = 0; k < signs.size(); ++k) rows.push_back({std::to_string(k + 1)});
  for (std::size_t c = 1; c < next.table.columns.size(); ++c) {
    const RecordedColumn& column = next.table.columns[c];
    if (c <= next.moves.size() && !next.moves[c - 1]) continue;
    if (column.name.starts_with("approach_")) {
      for (std::size_t k = 0; k < signs.size(); ++k) signs[k] += column.values[k] > 0 ? '+' : '-';
      continue;
    }
    if (column.name.starts_with("gravity.")) continue;  // in words
    const Unit unit = column.unit.text.empty() ? column.unit : units.of(column.unit.dimension);
    headings.push_back("." + column.name + (unit.text.empty() ? "" : "[" + unit.text + "]"));
    for (std::size_t k = 0; k < signs.size(); ++k)
      rows[k].push_back(fmt::format("{:.6g}", column.values[k] / unit.factor));
  }
  if (!signs.empty() && !signs[0].empty()) headings.emplace_back("<approach");
  if (purposes) headings.emplace_back("<to");
  Table table(headings);
  for (std::size_t k = 0; k < signs.size(); ++k) {
    if (!signs[k].empty()) rows[k].push_back(signs[k]);
    if (purposes) rows[k].push_back(join(next.poses[k].purposes, ", "));
    table.row(rows[k]);
  }
  std::string out = table.text();
  for (std::size_t k = 0; k < signs.size(); ++k)
    if (!next.poses[k].how.empty())
      out += wrapped(next.poses[k].how, fmt::format("  {:>4}: ", k + 1), "        ");
  return out;
}

std::string next_places(const NextRecordings& next, const Program& program) {
  const bool again = std::none_of(next.poses.begin(), next.poses.end(),
                                  [](const NextPose& p) { return std::isnan(p.again); });
  std::string out;
  if (again)
    out = "All are poses that were recorded.";
  else if (!next.loops.empty())
    out = "Poses close " + join(next.loops) + ", within the sensors' ranges.";
  else
    out = "The linkage is taken to be free to go anywhere within its sensors' ranges.";
  if (program.gravity && program.gravity->held_at >= 0 && next.loops.empty() && !again)
    out +=
        fmt::format(" What holds {} has to let it go there: the model does not know where it can.",
                    program.frames[static_cast<std::size_t>(program.gravity->held_at)].name);
  if (std::any_of(next.table.columns.begin(), next.table.columns.end(),
                  [](const RecordedColumn& c) { return c.name.starts_with("approach_"); }))
    out += " Approach: + from below (the joint's coordinate last grew), - from above.";
  if (!next.mounting.empty())
    out += " With " + next.mounting +
           ", gravity points as gravity.x, gravity.y and gravity.z of the table say: record these "
           "columns as well. Where they are empty it points as the model says.";
  return out;
}

std::string curve_plot(const Curve& curve) {
  if (curve.points.empty()) return "";
  constexpr int half = 20;
  double most = 0;
  for (const CurvePoint& p : curve.points)
    most = std::max({most, std::abs(p.before), std::abs(p.after)});
  std::string out = fmt::format(
      "  {} [{}] against {} [{}]; b before, a after\n  {:>10} {:>5} {:>10} {:>10} {:>9}\n", curve.y,
      curve.y_unit, curve.x, curve.x_unit, "x", "n", "before", "after", "± ");
  for (const CurvePoint& p : curve.points) {
    std::string line(2 * half + 1, ' ');
    auto mark = [&](double v, char c) {
      line[static_cast<std::size_t>(half + std::lround(half * (most > 0 ? v / most : 0)))] = c;
    };
    line[half] = '|';
    mark(p.after, 'a');
    mark(p.before, 'b');
    out += fmt::format("  {:>10.4g} {:>5} {:>10.3g} {:>10.3g} {:>8.2g} {}\n", p.x, p.count,
                       p.before, p.after, p.std, line);
  }
  return out;
}

}  // namespace talus
