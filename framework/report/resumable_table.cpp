#include "framework/report/resumable_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "framework/model/error.h"
#include "framework/report/report.h"

namespace talus {
namespace {

std::string fingerprint(const std::string& text) {  // FNV-1a
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return fmt::format("{:016x}", hash);
}

}  // namespace

ResumableTable::ResumableTable(std::string file, std::string what, const std::string& settings,
                               std::string header)
    : file_(std::move(file)),
      head_(fmt::format("# {}, settings {}\n{}\n", what, fingerprint(settings), header)) {
  if (file_.empty() || !std::filesystem::exists(file_)) return;
  std::ifstream in(file_, std::ios::binary);
  std::string comment, columns;
  std::getline(in, comment);
  std::getline(in, columns);
  if (!comment.starts_with("# " + what + ", settings "))
    throw InputError({file_, 1, 0}, "is there already, and is no table of " + what,
                     "a file that does not exist, or one that the same command began");
  if (comment + "\n" + columns + "\n" != head_)
    throw InputError({file_, 1, 0}, fmt::format("was begun by {} with other settings", what),
                     "the same models and options to go on with it, or another --table");
  const auto cells = std::count(header.begin(), header.end(), ',');
  for (std::string row; std::getline(in, row);)
    if (std::count(row.begin(), row.end(), ',') == cells)  // not one that was cut short
      rows_.push_back(row);
}

std::string ResumableTable::text() const {
  std::string out = head_;
  for (const std::string& row : rows_) out += row + "\n";
  return out;
}

void ResumableTable::add(const std::string& row) {
  rows_.push_back(row);
  if (!file_.empty()) write_file(file_, text());
}

}  // namespace talus
