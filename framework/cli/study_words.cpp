#include "framework/cli/study_words.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "framework/model/quantity.h"

namespace talus {

std::vector<Varied> parse_vary(const std::string& text) {
  std::vector<Varied> list;
  for (const std::string& part : CLI::detail::split(text, ';')) {
    const std::string word = CLI::detail::trim_copy(part);
    if (word.empty()) continue;
    const Place place{"--vary " + word, 0, 0};
    const std::size_t equals = word.find('=');
    const std::string expected = "element.attribute=first:last:step, or =a,b,c";
    if (equals == std::string::npos || word.find('.') > equals)
      throw InputError(place, "no attribute with its values", expected);
    Varied varied{CLI::detail::trim_copy(word.substr(0, equals)), {}};
    const std::string values = word.substr(equals + 1);
    auto as_number = [&](const std::string& s) {
      return parse_quantity(CLI::detail::trim_copy(s), number, {}, place).value;
    };
    if (values.find(':') == std::string::npos) {
      for (const std::string& v : CLI::detail::split(values, ','))
        varied.values.push_back(shortest(as_number(v)));
    } else {
      const auto words = CLI::detail::split(values, ':');
      if (words.size() != 3) throw InputError(place, "'" + values + "'", expected);
      const double first = as_number(words[0]), last = as_number(words[1]),
                   step = as_number(words[2]);
      if (!(step > 0) || last < first)
        throw InputError(place, "'" + values + "'", "first below last, and a step above zero");
      const double count = std::floor((last - first) / step + 1e-9);
      if (count > 1e4) throw InputError(place, fmt::format("{:.0f} values", count + 1), "10000");
      for (int i = 0; i <= static_cast<int>(count); ++i)
        varied.values.push_back(fmt::format("{:.12g}", first + i * step));
    }
    list.push_back(std::move(varied));
  }
  return list;
}

std::vector<std::vector<std::string>> designs_of(const std::vector<Varied>& varied) {
  std::vector<std::vector<std::string>> designs{{}};
  for (const Varied& v : varied) {
    std::vector<std::vector<std::string>> next;
    for (const auto& design : designs)
      for (const std::string& value : v.values) {
        next.push_back(design);
        next.back().push_back(value);
      }
    if (next.size() > 100000)
      throw InputError({"--vary", 0, 0}, fmt::format("{} designs or more", next.size()),
                       "at most 100000");
    designs = std::move(next);
  }
  return designs;
}

std::vector<double> parse_noise(const std::string& text) {
  std::vector<double> list;
  const Place place{"--noise", 0, 0};
  auto words = CLI::detail::split(text, ',');
  const std::size_t letter = words.back().find_first_of("abcdefghijklmnopqrstuvwxyz");
  const std::string unit = letter == std::string::npos ? "" : " " + words.back().substr(letter);
  if (letter != std::string::npos) words.back().erase(letter);
  for (const std::string& word : words) {
    list.push_back(
        parse_quantity(CLI::detail::trim_copy(word) + unit, angle, UnitSystem{}, place).value);
    if (!(list.back() > 0))
      throw InputError(place, "'" + CLI::detail::trim_copy(word) + "'", "more than zero");
  }
  return list;
}

}  // namespace talus
