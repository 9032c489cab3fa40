// A number at the start of a text, and a number as text: std::from_chars and std::to_chars where
// the standard library has them for doubles. Older ones (libc++ 13, with which the page is
// compiled) do with strtod and fmt, for the same grammar: no white space, no plus sign, no
// hexadecimal digits.
#pragma once

#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>

namespace talus {

struct Digits {
  std::size_t length;  // characters that make the number
  std::errc error;     // none, invalid_argument or result_out_of_range
};

inline Digits read_digits(std::string_view text, double& value) {
#ifdef __cpp_lib_to_chars
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return {static_cast<std::size_t>(end - text.data()), error};
#else
  const std::size_t first = text.starts_with('-') ? 1 : 0;
  const std::string_view bare = text.substr(first);
  const auto begins = [&](const char* word) { return bare.starts_with(word); };
  const bool number = bare.find_first_of("0123456789") == 0 ||
                      (bare.find_first_of("0123456789") == 1 && begins(".")) || begins("inf") ||
                      begins("INF") || begins("nan") || begins("NAN");
  if (!number) return {0, std::errc::invalid_argument};
  if (begins("0x") || begins("0X")) {
    value = 0;
    return {first + 1, std::errc()};
  }
  const std::string whole(text);
  char* end = nullptr;
  errno = 0;
  const double read = std::strtod(whole.c_str(), &end);
  const auto length = static_cast<std::size_t>(end - whole.c_str());
  if (errno == ERANGE) return {length, std::errc::result_out_of_range};
  value = read;
  return {length, std::errc()};
#endif
}

// To so many significant digits, as "%g" writes it.
inline std::string write_digits(double value, int digits) {
  return fmt::format("{:.{}g}", value, digits);
}

}  // namespace talus
