#include "framework/model/error.h"

#include <algorithm>

namespace talus {

std::string to_string(const Place& place) {
  std::string text = place.file;
  if (place.line > 0) text += (text.empty() ? "line " : ":") + std::to_string(place.line);
  if (place.line > 0 && place.column > 0) text += ":" + std::to_string(place.column);
  return text;
}

static std::string message(const Place& place, const std::string& found,
                           const std::string& expected, const std::string& suggestion) {
  std::string text = to_string(place);
  text += (text.empty() ? "" : ": ") + found;
  if (!expected.empty()) text += "\n  expected " + expected;
  if (!suggestion.empty()) text += "\n  did you mean '" + suggestion + "'?";
  return text;
}

InputError::InputError(const Place& place, const std::string& found, const std::string& expected,
                       const std::string& suggestion)
    : std::runtime_error(message(place, found, expected, suggestion)), place_(place) {}

// Optimal string alignment distance.
static size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<size_t>> d(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (size_t i = 1; i <= a.size(); ++i)
    for (size_t j = 1; j <= b.size(); ++j) {
      d[i][j] =
          std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  size_t best_distance = std::max<size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : candidates)
    if (size_t d = distance(word, candidate); d < best_distance)
      best = candidate, best_distance = d;
  return best;
}

std::string join(const std::vector<std::string>& words, std::string_view separator) {
  std::string text;
  for (const std::string& word : words) {
    if (!text.empty()) text += separator;
    text += word;
  }
  return text;
}

}  // namespace talus
