// A table that a long computation writes row by row, and takes up again where it stopped. The file
// is whole after every row. Its comment holds a fingerprint of everything the rows depend on, so
// rows of other settings are never mixed in.
//
//     ResumableTable table("study.csv", "talus study", settings, "design,noise[deg],rmse[mm]");
//     for (std::size_t i = table.rows().size(); i < all; ++i) table.add(row(i));
#pragma once

#include <string>
#include <vector>

namespace talus {

class ResumableTable {
 public:
  // `settings`: as text. Reads `file` where it exists; InputError where it holds something else.
  // With an empty name nothing is read or written.
  ResumableTable(std::string file, std::string what, const std::string& settings,
                 std::string header);
  const std::vector<std::string>& rows() const { return rows_; }
  void add(const std::string& row);  // and writes the file
  std::string text() const;

 private:
  std::string file_, head_;
  std::vector<std::string> rows_;
};

}  // namespace talus
