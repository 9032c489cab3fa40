// Every combination of the words of a plugin's choices, as their indices.
#pragma once

#include <vector>

#include "framework/registry/plugin.h"

namespace talus {

inline std::vector<std::vector<int>> combinations(const std::vector<Choice>& choices) {
  std::vector<std::vector<int>> result{{}};
  for (const Choice& choice : choices) {
    std::vector<std::vector<int>> longer;
    for (const auto& head : result)
      for (std::size_t i = 0; i < choice.words.size(); ++i) {
        longer.push_back(head);
        longer.back().push_back(static_cast<int>(i));
      }
    result = std::move(longer);
  }
  return result;
}

}  // namespace talus
