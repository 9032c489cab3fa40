#include "framework/dsl/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace talus {

namespace fs = std::filesystem;
constexpr std::uintmax_t most_bytes = 64u << 20;

std::string read_text(const std::string& file) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  const Place place{file, 0, 0};
  if (!fs::exists(status)) throw InputError(place, "no such file");
  if (fs::is_directory(status)) throw InputError(place, "is a folder", "a file");
  if (!fs::is_regular_file(status)) throw InputError(place, "is a device or pipe", "a file");
  if (fs::file_size(file, ignored) > most_bytes)
    throw InputError(place, fmt::format("is larger than {} MB", most_bytes >> 20), "a model file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(place, "cannot be read");
  std::ostringstream text;
  text << in.rdbuf();
  std::string whole = text.str();
  check_utf8(whole, file);
  return whole;
}

// Length of the character that starts here, 0 where there is none.
static std::size_t character_at(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first == 0) return 0;
  if (first < 0x80) return 1;
  const std::size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < size) return 0;
  for (std::size_t i = 1; i < size; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const bool too_long = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool no_scalar = (first == 0xED && byte(1) > 0x9F) || (first == 0xF4 && byte(1) > 0x8F);
  return too_long || no_scalar ? 0 : size;
}

void check_utf8(std::string_view text, const std::string& file) {
  Place place{file, 1, 1};
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = character_at(text.substr(i));
    if (size == 0)
      throw InputError(
          place,
          fmt::format("the byte 0x{:02X} is not UTF-8 text", static_cast<unsigned char>(text[i])),
          "a file saved as UTF-8 (tolerances may also be written in ASCII: 300 +- 0.5)");
    place.column = text[i] == '\n' ? 1 : place.column + 1;
    place.line += text[i] == '\n';
    i += size;
  }
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t size = character_at(text);
    if (size == 0) return false;
    text.remove_prefix(size);
  }
  return true;
}

std::string xml_escape(std::string_view text) {
  std::string result;
  for (char c : text) switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) < 0x20)
          result += fmt::format("&#{};", int(c));
        else
          result += c;
    }
  return result;
}

int characters(std::string_view utf8) {
  return static_cast<int>(
      std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string folder_of(const std::string& file) {
  const std::size_t slash = file.rfind('/');
  return slash == std::string::npos ? "" : file.substr(0, slash + 1);
}

std::string beside(const std::string& file, const std::string& relative) {
  return (fs::path(folder_of(file)) / relative).lexically_normal().string();
}

}  // namespace talus
