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
      const Quantity q = parse_quantity(CLI::detail::trim_copy(s), number, {}, place);
      if (q.free) throw InputError(place, "'" + s + "' is free", "a number without tolerance");
      return q.value;
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
    for (const Varied& other : list)
      if (other.name == varied.name)
        throw InputError(place, fmt::format("'{}' is varied twice", varied.name), "once");
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
  const auto words = CLI::detail::split(text, ',');
  // Where the unit stands behind the last number only, it is that of all.
  const std::string last = CLI::detail::trim_copy(words.back());
  const std::size_t blank = last.find(' ');
  const std::string unit = blank == std::string::npos ? "" : last.substr(blank);
  for (const std::string& word : words) {
    const std::string own = CLI::detail::trim_copy(word);
    const bool plain = own.find_first_not_of("+-0123456789.eE") == std::string::npos;
    list.push_back(parse_quantity(plain ? own + unit : own, angle, UnitSystem{}, place).value);
    if (!(list.back() > 0))
      throw InputError(place, "'" + CLI::detail::trim_copy(word) + "'", "more than zero");
  }
  return list;
}

}  // namespace talus
