#include "framework/recordings/cells.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/model/digits.h"

namespace talus {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }

// The length of the UTF-8 character at the start of `text`, 0 if it is none.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  const std::size_t n = first < 0x80   ? 1
                        : first < 0xC2 ? 0
                        : first < 0xE0 ? 2
                        : first < 0xF0 ? 3
                        : first < 0xF5 ? 4
                                       : 0;
  if (n > text.size()) return 0;
  for (std::size_t i = 1; i < n; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  return n;
}

}  // namespace

bool Lines::next() {
  if (rest_.empty()) return false;
  std::size_t end = rest_.find_first_of("\r\n");
  if (end == std::string_view::npos) end = rest_.size();
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(end);
  rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : rest_.empty() ? 0 : 1);
  ++number_;
  return true;
}

Place Lines::place(std::size_t offset) const {
  Place place{file_, number_, 1};
  for (char c : line_.substr(0, offset)) place.column += (c & 0xC0) != 0x80;
  return place;
}

void split_cells(const Lines& lines, char separator, std::vector<Cell>& cells) {
  cells.clear();
  const std::string_view line = lines.line();
  std::size_t at = 0;
  while (true) {
    const auto blank = [&](std::size_t i) { return is_blank(line[i]) && line[i] != separator; };
    while (at < line.size() && blank(at)) ++at;
    if (at < line.size() && line[at] == '"') {
      const std::size_t end = line.find('"', at + 1);
      if (end == std::string_view::npos)
        throw InputError(lines.place(at), "the quotation mark is not closed on its line",
                         "a second '\"'");
      cells.push_back({trim_blanks(line.substr(at + 1, end - at - 1)), at + 1});
      for (at = end + 1; at < line.size() && blank(at);) ++at;
      if (at < line.size() && line[at] != separator)
        throw InputError(lines.place(at), quoted(line.substr(at, 10)) + " after a quoted cell",
                         fmt::format("'{}' or the end of the line", separator));
    } else {
      std::size_t end = line.find(separator, at);
      if (end == std::string_view::npos) end = line.size();
      cells.push_back({trim_blanks(line.substr(at, end - at)), at});
      at = end;
    }
    if (at == line.size()) return;
    ++at;
  }
}

std::optional<double> read_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0;
  const auto [length, error] = read_digits(text, value);
  if (text.empty() || error != std::errc() || length != text.size()) return {};
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::string quoted(std::string_view text) {
  std::string out = "'";
  for (std::size_t characters = 0; !text.empty(); ++characters) {
    if (characters == 40) {
      out += "...";
      break;
    }
    const std::size_t n = character_length(text);
    const auto first = static_cast<unsigned char>(text[0]);
    if (n == 0 || first < 0x20 || first == 0x7F)
      out += fmt::format("\\x{:02X}", first);
    else
      out += text.substr(0, n);
    text.remove_prefix(std::max<std::size_t>(n, 1));
  }
  return out + "'";
}

void require_utf8(const Lines& lines) {
  for (std::string_view rest = lines.line(); !rest.empty();) {
    const std::size_t n = character_length(rest);
    if (n == 0)
      throw InputError(
          lines.place(rest.data() - lines.line().data()),
          fmt::format("the byte 0x{:02X} is not UTF-8", static_cast<unsigned char>(rest[0])),
          "a file saved as UTF-8");
    rest.remove_prefix(n);
  }
}

std::string_view require_text(std::string_view text, const std::string& file,
                              const std::string& expected) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw InputError(Place{file}, "the file is UTF-16", "a file saved as UTF-8");
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (text.find('\0') != std::string_view::npos)
    throw InputError(Place{file}, "the file is not text", expected);
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
    throw InputError(Place{file}, "the file is empty", expected);
  return text;
}

std::string_view trim_blanks(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace talus
