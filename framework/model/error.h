// Bad input at the borders: every complaint names the place (file, line, column), what was found,
// what was expected and, where there is one, the nearest valid name.
//
//     models/arm.xml:12:18: <dh> has no attribute 'alhpa'
//       expected one of: name, theta, d, a, alpha
//       did you mean 'alpha'?
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace talus {

// A position in a user's file; line and column count from 1, 0 means unknown.
struct Place {
  std::string file;
  int line = 0;
  int column = 0;
};

std::string to_string(const Place& place);  // "file:line:column", leaving out what is unknown

// The one exception of the framework: the user's input cannot be used. Commands exit with 2 on it.
class InputError : public std::runtime_error {
 public:
  InputError(const Place& place, const std::string& found, const std::string& expected = {},
             const std::string& suggestion = {});
  explicit InputError(const std::string& found) : InputError(Place{}, found) {}
  const Place& place() const { return place_; }

 private:
  Place place_;
};

// The candidate nearest to `word` by edit distance (insert, delete, replace, swap neighbours), or
// "" when none is near enough to be meant.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

// "a, b, c"
std::string join(const std::vector<std::string>& words, std::string_view separator = ", ");

}  // namespace talus
