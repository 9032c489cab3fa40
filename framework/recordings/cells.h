// Tables of text taken apart: lines, cells and numbers, each with its place. Shared by the readers
// of CSV and of marker files (TRC).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/model/error.h"

namespace talus {

struct Cell {
  std::string_view text;   // without quotes and blanks around it
  std::size_t offset = 0;  // of its first character, in bytes from the start of the line
};

// The lines of a text one by one, whichever way they end; counts them.
class Lines {
 public:
  explicit Lines(std::string_view text, const std::string& file) : rest_(text), file_(file) {}
  bool next();
  std::string_view line() const { return line_; }
  int number() const { return number_; }
  // `offset` counts bytes from the start of the line, the place's column characters.
  Place place(std::size_t offset) const;

 private:
  std::string_view rest_, line_;
  const std::string& file_;
  int number_ = 0;
};

// The cells of the present line. A cell may stand in double quotes.
void split_cells(const Lines& lines, char separator, std::vector<Cell>& cells);

// A finite number, or nothing.
std::optional<double> read_number(std::string_view text);

// The text in single quotes for a message: shortened, and with what is not printable UTF-8 escaped.
std::string quoted(std::string_view text);

// Throws where the text is no UTF-8 (checks the present line).
void require_utf8(const Lines& lines);

// Takes off a byte order mark; throws for an empty file, for UTF-16 and for a binary file.
std::string_view require_text(std::string_view text, const std::string& file,
                              const std::string& expected);

std::string_view trim_blanks(std::string_view text);  // spaces and tabs

}  // namespace talus
