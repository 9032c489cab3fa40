#include "framework/report/layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

// Characters before the decimal point; all where there is none, 0 where it is no number.
std::size_t whole_part(const std::string& cell) {
  if (cell.find_first_of("0123456789") == std::string::npos) return 0;
  return columns_of(cell.substr(0, cell.find('.')));
}

}  // namespace

std::size_t columns_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) >> 6) != 2; }));
}

std::string wrapped(const std::string& text, const std::string& first, const std::string& more,
                    std::size_t width) {
  std::string out = first;
  std::size_t column = columns_of(first);
  auto trim = [&] {
    while (!out.empty() && out.back() == ' ') out.pop_back();
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size()),
                      next = std::min(text.find_first_not_of(' ', end), text.size());
    const std::size_t size = columns_of(text.substr(at, end - at));
    if (column + size > width && column > columns_of(more)) {
      trim();
      out += "\n" + more;
      column = columns_of(more);
    }
    out += text.substr(at, next - at);
    column += size + (next - end);
    at = next;
  }
  trim();
  return out + "\n";
}

std::string figure(double value) {
  if (!std::isfinite(value)) return "-";
  if (value == 0) return "0";
  const int decimals =
      std::clamp(3 - static_cast<int>(std::floor(std::log10(std::abs(value)))), 0, 7);
  return fmt::format("{:.{}f}", value, decimals);
}

int decimals_for(double std) {
  if (!(std > 0) || !std::isfinite(std)) return 4;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(std))), 0, 7);
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return std::isnan(value) ? "-" : "unseen";
  return fmt::format("{:.{}f}", value, decimals);
}

std::string counted(std::size_t n, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

Table::Table(std::vector<std::string> headings) : headings_(std::move(headings)) {
  for (std::string& heading : headings_) {
    alignment_ += heading[0];
    heading.erase(0, 1);
  }
}

std::string Table::text(std::size_t indent) const {
  const std::size_t count = headings_.size();
  std::vector<std::size_t> whole(count, 0), width(count);
  for (std::size_t c = 0; c < count; ++c) {
    std::size_t rest = 0;
    for (const auto& row : rows_)
      if (c < row.size() && alignment_[c] == '.' && whole_part(row[c]) > 0) {
        whole[c] = std::max(whole[c], whole_part(row[c]));
        rest = std::max(rest, columns_of(row[c]) - whole_part(row[c]));
      }
    width[c] = std::max(columns_of(headings_[c]), whole[c] + rest);
    for (const auto& row : rows_)
      if (c < row.size()) width[c] = std::max(width[c], columns_of(row[c]));
    whole[c] = width[c] - rest;  // numbers stand at the right end of their column
  }
  std::string out;
  auto line = [&](const std::vector<std::string>& cells, bool heading) {
    std::string text(indent, ' ');
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::size_t size = columns_of(cells[c]), free = width[c] - size;
      std::size_t before = alignment_[c] == '<' ? 0 : free;
      if (alignment_[c] == '.' && !heading && whole_part(cells[c]) > 0)
        before = whole[c] - whole_part(cells[c]);
      if (c > 0) text += "  ";
      text += std::string(before, ' ') + cells[c] + std::string(free - before, ' ');
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out += text + "\n";
  };
  line(headings_, true);
  for (const auto& row : rows_) line(row, false);
  return out;
}

}  // namespace talus
