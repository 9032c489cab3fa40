// How text for people is set: prose wrapped, tables whose columns are as wide as they need to be.
// Columns count characters, not bytes: "±" is one.
//
//     Table table({"<measure", "<unit", ".RMSE"});     // left, right (">"), at the decimal point
//     table.row({"E.x", "mm", "0.0546"});
//     table.text();
#pragma once

#include <string>
#include <vector>

namespace talus {

constexpr std::size_t kTextWidth = 80;

std::size_t columns_of(const std::string& text);  // on a screen

// Broken at blanks, ends with a new line; `more` begins each further line.
std::string wrapped(const std::string& text, const std::string& first, const std::string& more,
                    std::size_t width = kTextWidth);

// Four significant digits, without exponents where they are not needed; "-" where not finite.
std::string figure(double value);
// Decimals that show an uncertainty with two digits, within reason.
int decimals_for(double std);
// "3.1416", "-" where not a number, "unseen" where infinite.
std::string fixed(double value, int decimals);
std::string counted(std::size_t n, const std::string& one, const std::string& many);  // "3 poses"

class Table {
 public:
  explicit Table(std::vector<std::string> headings);
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  void clear() { rows_.clear(); }
  bool empty() const { return rows_.empty(); }
  std::string text(std::size_t indent = 2) const;  // the headings, then the rows

 private:
  std::string alignment_;  // of each column
  std::vector<std::string> headings_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace talus
