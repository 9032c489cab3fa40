#include "framework/diagnosis/seen.h"

#include <algorithm>

#include "framework/diagnosis/blind_spots.h"
#include "framework/diagnosis/screen_inside.h"

namespace talus {
namespace {

// One amount at so many typical ones, as it is shown.
ShownValue magnitude_of(const Suspect& suspect, const Way& way, double times,
                        const UnitSystem& units) {
  Accepted e{suspect, way, std::vector<double>(way.amounts.size(), 0),
             std::vector<double>(way.amounts.size(), 0)};
  std::size_t at = 0;
  for (const Figure& f : suspect.plugin->declaration.effect.figures) {
    const auto first = std::find(way.amounts.begin(), way.amounts.end(), f.amounts[0]);
    const bool whole = std::all_of(f.amounts.begin(), f.amounts.end(), [&](const auto& a) {
      return std::find(way.amounts.begin(), way.amounts.end(), a) != way.amounts.end();
    });
    if (!whole) continue;
    at = static_cast<std::size_t>(first - way.amounts.begin());
    break;
  }
  e.amounts[at] = times * way.typical[at];
  ShownValue shown = shown_values(e, units).at(0);
  shown.value = std::abs(shown.value);
  if (shown.unit.ends_with("/s") && shown.value < 1e-3 * times) {  // a drift
    shown.value *= 3600;
    shown.unit.back() = 'h';
  }
  return shown;
}

}  // namespace

Seen seen(const Diagnosis& diagnosis, const Linearised& null, int threads) {
  const Stage& stage = *diagnosis.search.stage;
  const UnitSystem& units = diagnosis.program->units;
  SensitivityOptions options;
  options.threads = threads;
  if (diagnosis.search.first.threshold < 0)
    options.log_threshold = diagnosis.search.first.threshold;
  Seen result;
  result.untestable = stage.suspects.untestable;
  std::vector<Pick> picks;
  std::vector<int> of;
  for (const Sensitivity& s : sensitivity(stage.screen, options)) {
    const Suspect& suspect = stage.suspects.suspects[s.suspect];
    const Way& way = stage.suspects.ways[s.pick.form];
    const ShownValue typical = magnitude_of(suspect, way, 1, units);
    SeenSuspect entry{suspect.effect, suspect.location, typical.name, typical.unit};
    entry.typical = typical.value;
    entry.smallest = s.smallest_visible * typical.value;
    entry.visible = s.visible;
    if (s.nearest >= 0) {
      const Suspect& rival = stage.suspects.suspects[s.nearest];
      entry.rival = rival.effect, entry.rival_location = rival.location;
      entry.imitates = s.imitates;
    }
    entry.sensitivity = s;
    if (!entry.unknown() && std::isfinite(s.smallest_visible)) {
      picks.push_back(s.pick);
      of.push_back(static_cast<int>(result.suspects.size()));
    }
    result.suspects.push_back(std::move(entry));
  }
  for (const std::vector<int>& group : stage.screen.classes(picks)) {
    if (group.size() < 2) continue;
    result.twins.emplace_back();
    for (const int i : group) result.twins.back().push_back(of[i]);
  }
  result.blind = blind_spots(result, *diagnosis.program, null, diagnosis.recordings,
                             options.log_threshold, stage.screen.inside().noise);
  return result;
}

}  // namespace talus
