#include "framework/report/layout.h"

#include <doctest/doctest.h>

#include "framework/report/progress.h"

using namespace talus;

TEST_CASE("a table's columns are as wide as needed, numbers at the decimal point") {
  Table table({"<name", ".value", ">n", "<unit"});
  table.row({"a", "1.25", "3", "mm"});
  table.row({"longer", "-100.5", "12", "µm"});
  table.row({"b", "7", "1", ""});
  table.row({"c", "-", "1", "deg"});
  CHECK(table.text() ==
        "  name      value   n  unit\n"
        "  a          1.25   3  mm\n"
        "  longer  -100.5   12  µm\n"
        "  b          7      1\n"
        "  c             -   1  deg\n");
}

TEST_CASE("prose is broken at blanks, by what a screen shows") {
  CHECK(wrapped("one two three", "A. ", "  ", 8) == "A. one\n  two\n  three\n");
  CHECK(wrapped("± ± ± ±", "", "  ", 7) == "± ± ± ±\n");
  CHECK(wrapped("unbreakablylong", "", "  ", 5) == "unbreakablylong\n");
}

TEST_CASE("the bar fits its line, whatever the width") {
  CHECK(progress_line("fitting", 0.25, 8, 120, 80) ==
        "fitting        [#######                       ]  25 %, about 2 min left");
  CHECK(progress_line("simulating", 0, 3.2, -1, 80) == "simulating     3 s");
  CHECK(progress_line("fitting", 0.5, 8, 8, 50) ==
        "fitting        [####    ]  50 %, about 8 s left");
  for (std::size_t width = 10; width < 100; ++width)
    CHECK(progress_line("fitting", 0.5, 8, 5000, width).size() < width);
  CHECK(time_left(0) == "about 1 s left");
  CHECK(time_left(89) == "about 89 s left");
  CHECK(time_left(100) == "about 2 min left");
  CHECK(time_left(7200) == "about 2 h left");
}
