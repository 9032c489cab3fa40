#include "framework/calibration/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "framework/kinematics/covariates.h"
#include "framework/model/quantity.h"

namespace talus {

std::vector<Coordinate> coordinates(const Program& program) {
  std::vector<Coordinate> list;
  const std::pair<double, double> turn(-60 * deg, 60 * deg);
  for (const Reading& r : program.readings) {
    if (r.covariate) {
      list.push_back({r.sensor, r.column, r.dimension, usual_value(r.column), {}, true});
      continue;
    }
    const bool outside = r.range && (r.range->first > 0 || r.range->second < 0);
    list.push_back({r.sensor, r.column, r.dimension,
                    outside ? (r.range->first + r.range->second) / 2 : 0, r.range});
    if (!r.range && r.dimension == angle) list.back().range = turn;
  }
  for (const Unknown& u : program.unknowns) {
    list.push_back({u.name, u.name, u.dimension, u.start.value, {}});
    if (!u.per.empty()) continue;
    if (u.start.bounds && std::isfinite(u.start.bounds->first) &&
        std::isfinite(u.start.bounds->second))
      list.back().range = u.start.bounds;
    else if (u.dimension == angle)
      list.back().range = turn;
  }
  return list;
}

namespace {

std::vector<std::string> words_of(const std::string& text, char separator) {
  std::vector<std::string> words{""};
  for (char c : text) {
    if (c == separator)
      words.emplace_back();
    else
      words.back() += c;
  }
  return words;
}

}  // namespace

Settings random_settings(const Program& program, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::vector<Coordinate> list = coordinates(program);
  Settings settings;
  for (int k = 0; k < count; ++k) {
    auto& pose = settings.poses.emplace_back();
    for (const Coordinate& c : list)
      pose.push_back(c.range ? std::uniform_real_distribution<double>(
                                   c.range->first, std::nextafter(c.range->second, 1e300))(random)
                             : c.rest);
  }
  return settings;
}

Settings grid_settings(const Program& program, const std::string& grid) {
  const std::vector<Coordinate> list = coordinates(program);
  std::vector<std::string> names;
  std::vector<std::vector<double>> axes;
  for (const Coordinate& c : list) {
    names.push_back(is_derived(c.column) ? "" : c.name);  // not to be chosen
    axes.push_back({c.rest});
  }
  const Place place{"--grid", 0, 0};
  std::vector<std::string> seen;
  for (const std::string& part : words_of(grid, ';')) {
    const std::size_t equals = part.find('=');
    std::string name = part.substr(0, equals);
    std::erase(name, ' ');
    if (name.empty() && equals == std::string::npos) continue;
    const auto it = std::find(names.begin(), names.end(), name);
    if (name.empty() || it == names.end() || equals == std::string::npos) {
      std::vector<std::string> known = names;
      std::erase(known, "");
      throw InputError(place, fmt::format("'{}'", part),
                       "name=first:last:step or name=a,b,c with one of: " + join(known),
                       nearest(name, known));
    }
    const Coordinate& c = list[it - names.begin()];
    auto value = [&](const std::string& text) {
      const Quantity q = parse_quantity(text, c.dimension, program.units, place);
      if (q.free)
        throw InputError(place, fmt::format("'{}' has a tolerance", text), "a plain value");
      return q.value;
    };
    if (std::find(seen.begin(), seen.end(), name) != seen.end())
      throw InputError(place, fmt::format("'{}' is given twice", name), "each name once");
    seen.push_back(name);
    const std::string values = part.substr(equals + 1);
    auto& axis = axes[it - names.begin()];
    axis.clear();
    if (values.find(':') == std::string::npos) {
      for (const std::string& w : words_of(values, ',')) axis.push_back(value(w));
      continue;
    }
    const std::vector<std::string> words = words_of(values, ':');
    if (words.size() != 3) throw InputError(place, fmt::format("'{}'", values), "first:last:step");
    const double first = value(words[0]), last = value(words[1]), step = value(words[2]);
    if (!(step > 0) || last < first)
      throw InputError(place, fmt::format("'{}'", values),
                       "first below last, and a step above zero");
    const double count = std::floor((last - first) / step + 1e-9);
    if (count > 1e6)
      throw InputError(place, fmt::format("'{}' makes {:.3g} values", values, count + 1),
                       "at most a million");
    for (int i = 0; i <= static_cast<int>(count); ++i) axis.push_back(first + i * step);
  }
  Settings settings{{{}}};
  double size = 1;
  for (const auto& axis : axes) size *= static_cast<double>(axis.size());
  if (size > 1e6) throw InputError(place, fmt::format("{:.3g} poses", size), "at most a million");
  for (const auto& axis : axes) {
    std::vector<std::vector<double>> next;
    for (const auto& pose : settings.poses)
      for (double v : axis) {
        next.push_back(pose);
        next.back().push_back(v);
      }
    settings.poses = std::move(next);
  }
  return settings;
}

}  // namespace talus
