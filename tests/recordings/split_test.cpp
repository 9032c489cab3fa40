#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "framework/recordings/recordings.h"

using namespace talus;

namespace {

Recordings table(const std::vector<std::pair<std::string, std::vector<double>>>& columns) {
  Recordings r;
  r.file = "r.csv";
  for (const auto& [name, values] : columns) r.columns.push_back({name, Unit{}, values, {}});
  for (std::size_t i = 0; i < r.columns[0].values.size(); ++i)
    r.lines.push_back(static_cast<int>(i) + 2);
  return r;
}

std::vector<double> counting(int n) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(i);
  return values;
}

// Every row is on one side, and no group on both.
void check_whole(const Split& split, std::size_t rows) {
  std::set<std::size_t> all(split.fit.begin(), split.fit.end());
  all.insert(split.check.begin(), split.check.end());
  CHECK(all.size() == rows);
  CHECK(split.fit.size() + split.check.size() == rows);
  CHECK(std::is_sorted(split.fit.begin(), split.fit.end()));
  CHECK(std::is_sorted(split.check.begin(), split.check.end()));
  std::set<int> fitted;
  for (std::size_t row : split.fit) fitted.insert(split.group[row]);
  for (std::size_t row : split.check) CHECK(fitted.count(split.group[row]) == 0);
}

}  // namespace

TEST_CASE("the column use decides") {
  Recordings r = table({{"pose", counting(4)}});
  r.use = std::vector<bool>{true, false, false, true};
  const Split split = split_rows(r, {.check_share = 0.9});
  CHECK(split.fit == std::vector<std::size_t>{0, 3});
  CHECK(split.check == std::vector<std::size_t>{1, 2});
  r.use = std::vector<bool>{false, false, false, false};
  CHECK_THROWS_WITH_AS(
      split_rows(r, {}),
      "r.csv: no row is to be fitted\n  expected the word fit in some rows of the column 'use'",
      InputError);
}

TEST_CASE("a share of the rows is drawn from the seed") {
  const Recordings r = table({{"pose", counting(1000)}});
  const Split split = split_rows(r, {.check_share = 0.3, .seed = 1});
  check_whole(split, 1000);
  CHECK(split.check.size() == 300);
  CHECK(split_rows(r, {.check_share = 0.3, .seed = 1}).check == split.check);
  CHECK(split_rows(r, {.check_share = 0.3, .seed = 2}).check != split.check);
  CHECK(split_rows(r, {.check_share = 0}).check.empty());
  // Over the whole table, not only its end.
  CHECK(std::count_if(split.check.begin(), split.check.end(),
                      [](std::size_t i) { return i < 500; }) > 100);
  CHECK_THROWS_AS(split_rows(r, {.check_share = 1}), InputError);
  CHECK_THROWS_AS(split_rows(r, {.check_share = -0.1}), InputError);
  CHECK_THROWS_AS(split_rows(r, {.check_share = std::nan("")}), InputError);
}

TEST_CASE("the draw is the same on every platform") {
  const Split split = split_rows(table({{"pose", counting(10)}}), {.check_share = 0.3, .seed = 1});
  CHECK(split.check == std::vector<std::size_t>{1, 3, 7});
}

TEST_CASE("small tables keep a row on either side") {
  CHECK(split_rows(table({{"pose", counting(2)}}), {.check_share = 0.01}).check.size() == 1);
  CHECK(split_rows(table({{"pose", counting(2)}}), {.check_share = 0.99}).fit.size() == 1);
  CHECK(split_rows(table({{"pose", counting(1)}}), {}).fit.size() == 1);
}

TEST_CASE("rows with equal ids stay together") {
  std::vector<double> star, night;
  for (int i = 0; i < 200; ++i) star.push_back(i % 23), night.push_back(i % 2);
  const Recordings r = table({{"star", star}, {"night", night}});
  const Split by_star = split_rows(r, {.group_columns = {{"star"}}});
  check_whole(by_star, 200);
  CHECK(*std::max_element(by_star.group.begin(), by_star.group.end()) == 22);
  CHECK(by_star.group[0] == by_star.group[23]);
  CHECK(by_star.group[0] != by_star.group[1]);
  const Split by_both = split_rows(r, {.group_columns = {{"star", "night"}}});
  CHECK(*std::max_element(by_both.group.begin(), by_both.group.end()) == 45);
  CHECK(by_both.group[0] != by_both.group[23]);
  CHECK(by_both.group[0] == by_both.group[46]);
  const Split by_either =
      split_rows(r, {.group_columns = {{"star"}, {"night"}}});  // stars link the nights
  CHECK(*std::max_element(by_either.group.begin(), by_either.group.end()) == 0);
  CHECK_THROWS_WITH_AS(
      split_rows(r, {.group_columns = {{"stars"}}}),
      "r.csv: there is no column 'stars'\n  expected one of: star, night\n  did you mean 'star'?",
      InputError);
}

TEST_CASE("repeats of a setting stay together") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Recordings r =
      table({{"q1", {0, 1, 0, 1, 1e-12, nan, nan}}, {"q2", {5, 5, 5, 6, 5, 5, 5}}});
  const Split split = split_rows(r, {.reading_columns = {"q1", "q2"}});
  CHECK(split.group == std::vector<int>{0, 1, 0, 2, 0, 3, 4});
  // 0 and 0.9 are near by q1 only as long as 0.5 links them, which differs in q2.
  const Recordings s = table({{"q1", {0, 0.5, 0.9}}, {"q2", {0, 9, 0}}});
  CHECK(split_rows(s, {.reading_columns = {"q1", "q2"}, .repeat_tolerance = 0.6}).group ==
        std::vector<int>{0, 1, 2});
  CHECK(split_rows(s, {.reading_columns = {"q1"}, .repeat_tolerance = 0.6}).group ==
        std::vector<int>{0, 0, 0});
}

TEST_CASE("ids and repeats join into one group") {
  const Recordings r = table({{"star", {1, 1, 2, 3}}, {"q", {10, 20, 20, 30}}});
  CHECK(split_rows(r, {.group_columns = {{"star"}}, .reading_columns = {"q"}}).group ==
        std::vector<int>{0, 0, 0, 1});
}

TEST_CASE("folds hold out every row once, groups whole, sizes about equal") {
  std::vector<int> group;
  for (int i = 0; i < 300; ++i) group.push_back(i / 3);
  const auto held_out = folds(group, 5, 1);
  REQUIRE(held_out.size() == 5);
  std::vector<int> fold_of_group(100, -1), times(300, 0);
  for (std::size_t k = 0; k < held_out.size(); ++k) {
    CHECK(held_out[k].size() == 60);
    CHECK(std::is_sorted(held_out[k].begin(), held_out[k].end()));
    for (std::size_t row : held_out[k]) {
      ++times[row];
      int& fold = fold_of_group[group[row]];
      CHECK((fold == -1 || fold == static_cast<int>(k)));
      fold = static_cast<int>(k);
    }
  }
  CHECK(times == std::vector<int>(300, 1));
  CHECK(folds(group, 5, 1) == held_out);
  CHECK(folds(group, 5, 2) != held_out);
  CHECK(folds({0, 0, 1}, 5, 1).size() == 2);  // no more folds than groups
  CHECK(folds({0, 0, 0}, 5, 1).empty());
}
