// Finds in a Lua model's text where an element and its attributes are written. Lua tells the line
// of the constructor's call only; from there the text is searched. Where the text does not show it
// (a table made elsewhere), the line is all there is.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/model/model.h"

namespace talus {

class LuaSource {
 public:
  LuaSource(std::string_view text, std::string file);

  // Sets the places of an element and its attributes, the call being on `line`.
  void locate(Element& element, int line) const;

 private:
  std::size_t find_call(const Element& element, int line) const;
  std::size_t find_value(std::size_t call, std::string_view key) const;
  bool literally(std::size_t value, std::string_view text) const;
  Place place(std::size_t at) const;

  std::string_view text_;
  std::string file_;
  std::vector<std::size_t> lines_;  // where they begin
};

}  // namespace talus
