#include "framework/model/quantity.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace talus;

namespace {

const UnitSystem units;

Quantity read(const char* text, Dimension dimension = length) {
  return parse_quantity(text, dimension, units, Place{"arm.xml", 12, 10});
}

std::string complaint(const char* text, Dimension dimension = length) {
  try {
    read(text, dimension);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

}  // namespace

TEST_CASE("fixed, free, with a tolerance") {
  CHECK(read("300").value == 300);
  CHECK_FALSE(read("300").free);
  CHECK(read("300 ?").free);
  CHECK_FALSE(read("300 ?").tolerance);
  for (const char* text :
       {"300 ± 0.5", "300 +- 0.5", "300 +/- 0.5", "300±0.5", " 300  ±  0.5 ", "3e2 ± 5e-1"}) {
    CAPTURE(text);
    const Quantity q = read(text);
    CHECK(q.value == 300);
    CHECK(q.free);
    CHECK(q.tolerance.value() == 0.5);
    CHECK_FALSE(q.bounds);
  }
  CHECK(read("-.5 ± +1").value == -0.5);
}

TEST_CASE("units: the default, one's own, one for all") {
  CHECK(read("90", angle).value == doctest::Approx(std::acos(-1.0) / 2).epsilon(1e-15));
  CHECK(read("1.5708 rad", angle).value == 1.5708);
  CHECK(read("1.5 rad ± 0.1", angle).tolerance.value() == 0.1);  // the value's
  CHECK(read("1.5 ± 0.1 rad", angle).value == 1.5);              // the tolerance's
  CHECK(read("300 mm ± 500 um").tolerance.value() == 0.5);
  CHECK(read("3 ± 0.5 m").value == 3000);
  const Quantity q = read("300 ± 0.5 mm [0, 0.31 m]");
  CHECK(q.bounds.value() == std::pair(0.0, 310.0));
  CHECK(read("3 ± 0.5 [2, 4] m").bounds.value() == std::pair(2000.0, 4000.0));
  CHECK(read("0.3 [0.29 m, 0.31]").bounds.value() == std::pair(290.0, 310.0));
  CHECK(read("0 ? [0, inf]").bounds->second == std::numeric_limits<double>::infinity());
  CHECK(read("0.5 deg/(N*m)", angle / torque).value == doctest::Approx(0.5 * deg / 1e6));
}

TEST_CASE("a temperature in kelvin has an offset, its tolerance has none") {
  const Quantity q = read("293.15 ± 2 K", temperature);
  CHECK(q.value == doctest::Approx(20));
  CHECK(q.tolerance.value() == 2);
}

TEST_CASE("complaints about quantities, to the letter") {
  CHECK(complaint("300,5") ==
        "arm.xml:12:13: '300,5' has a decimal comma\n"
        "  expected a decimal point\n"
        "  did you mean '300.5'?");
  CHECK(complaint("300 ± 0,5") ==
        "arm.xml:12:17: '0,5' has a decimal comma\n"
        "  expected a decimal point\n"
        "  did you mean '0.5'?");
  CHECK(complaint("300 ± 1 mmm") ==
        "arm.xml:12:18: 'mmm' is not a unit\n"
        "  expected a length (mm, m, um, cm, in)\n"
        "  did you mean 'mm'?");
  CHECK(complaint("300 deg") ==
        "arm.xml:12:14: 'deg' measures an angle\n"
        "  expected a length (mm, m, um, cm, in)");
  CHECK(complaint("300 mm", number) ==
        "arm.xml:12:14: 'mm' measures a length\n"
        "  expected a plain number (no unit)");
  CHECK(complaint("300 ± -1") ==
        "arm.xml:12:16: the tolerance -1 is not positive\n"
        "  expected a positive tolerance, or the number alone where it is fixed");
  CHECK(complaint("300 [310, 290]") ==
        "arm.xml:12:14: the bounds [310, 290] hold no number\n"
        "  expected the lower bound first, then a larger one");
  CHECK(complaint("300 [1, 2]") ==
        "arm.xml:12:10: 300 is out of its bounds [1, 2]\n"
        "  expected a number within them");
  CHECK(complaint("300 5") ==
        "arm.xml:12:14: '5' is left over\n"
        "  expected nothing more after '300'");
  CHECK(complaint("300 ± 1 ± 2") ==
        "arm.xml:12:18: '± 2' is left over\n"
        "  expected nothing more after '300 ± 1'");
  CHECK(complaint("300 ± 1 ?  ") ==
        "arm.xml:12:18: '?' after a tolerance\n"
        "  expected either '± tolerance' or '?'");
  CHECK(complaint("300 ±") ==
        "arm.xml:12:15: the text ends after '300 ±'\n"
        "  expected a tolerance after '±'");
  CHECK(complaint("") ==
        "arm.xml:12:10: there is no number here\n"
        "  expected a number, such as 300 or 300 ± 0.5");
  CHECK(complaint("long") ==
        "arm.xml:12:10: 'long' is not a number\n"
        "  expected a number, such as 300 or 300 ± 0.5");
  CHECK(complaint("1.2.3") ==
        "arm.xml:12:10: '1.2.3' is not a number\n"
        "  expected digits with one decimal point");
  CHECK(complaint("−5") ==
        "arm.xml:12:10: '−5' has a typographic minus sign\n"
        "  expected a number\n"
        "  did you mean '-5'?");
  CHECK(complaint("1 [0, 2") ==
        "arm.xml:12:17: the text ends after '1 [0, 2'\n"
        "  expected ']' after the two bounds; decimals have a point");
  CHECK(complaint("1 [0,5, 2,5]") ==
        "arm.xml:12:16: ', 2,5]' is left over\n"
        "  expected ']' after the two bounds; decimals have a point");
}

TEST_CASE("what is never read as a number") {
  for (const char* text :
       {"nan", "inf", "-inf", "1e999", "0x10", "± 1", "300 ± nan", "300 ± 0", "1 ? ± 2", "1 2 mm",
        "[1, 2]", "1 [2]", "1 [1, 1]", "1 [0, 2] 3", "300 + 5", "300 ± inf"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(read(text), InputError);
  }
}

TEST_CASE("a place without a column gets none") {
  try {
    parse_quantity("1 foo", length, units, Place{"arm.lua", 3, 0});
    FAIL("no complaint");
  } catch (const InputError& error) {
    CHECK(error.place().line == 3);
    CHECK(error.place().column == 0);
  }
}

TEST_CASE("quantity or expression?") {
  for (const char* text :
       {"300", "-3 m", ".5", "1e-3", "300 mm", "0 ?", "0 +- 1", "300 ± 0.5 [290, 310]", "300,5",
        "3 mmm", "5 1/degC", "5 deg/(N*m)", "0.01 deg/(N*mm2) ± 1", "−5"}) {
    CAPTURE(text);
    CHECK(looks_like_quantity(text));
  }
  for (const char* text : {"encoder1", "2*L", "-(q2 + q3)", "90 deg + encoder1", "90 deg*encoder1",
                           "2 +-x", "3 - 2", "2 mm * L", "(3)", "", "-q1", "joint2.a"}) {
    CAPTURE(text);
    CHECK_FALSE(looks_like_quantity(text));
  }
}

TEST_CASE("written as it was read") {
  const auto again = [](const char* text, Dimension dimension = length, int digits = 0) {
    return write_quantity(read(text, dimension), dimension, units, digits);
  };
  for (const char* text :
       {"300", "300 ?", "300 ± 0.5", "300 ± 0.5 [290, 310]", "0.1", "-0.3 ?", "0 ? [0, inf]"}) {
    CHECK(again(text) == text);
    CHECK(again(text, angle) == text);
    CHECK(again(text, number) == text);
  }
  CHECK(again("0 ± 0.02 deg/(N*m)", angle / torque) == "0 ± 0.02 deg/(N*m)");
  CHECK(again("20 ?", temperature) == "20 degC ?");
  CHECK(again("0.3 m ± 500 um") == "300 ± 0.5");
  CHECK(again("-0") == "0");
  for (int i = 1; i < 1000; ++i) {
    const std::string text = shortest(i / 100.0);  // "0.07", never "0.07000000000000001"
    REQUIRE(again(text.c_str(), angle) == text);
  }
}

TEST_CASE("rounded to the digits of the tolerance") {
  const auto rounded = [](const char* text) {
    return write_quantity(read(text), length, units, 2);
  };
  CHECK(rounded("300.123456 ± 0.0456") == "300.123 ± 0.046");
  CHECK(rounded("300.123456 ± 0.0996") == "300.12 ± 0.10");
  CHECK(rounded("300.123456 ± 123") == "300 ± 120");
  CHECK(rounded("300.126 ± 0.1 [300.125, 300.1262]") ==
        "300.126 ± 0.10 [300.125, 300.1262]");  // not out of bounds
  CHECK(rounded("300.124 ± 0.1 [300.1235, 301]") == "300.124 ± 0.10 [300.1235, 301]");
  CHECK(rounded("300.123456") == "300.123456");
}

TEST_CASE("what is written reads back as the same double, or its neighbour") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(-1, 1), exponent(-8, 8);
  for (Dimension dimension : {length, number, angle, angle / torque, temperature}) {
    for (int i = 0; i < 2000; ++i) {
      Quantity q{.value = mantissa(random) * std::pow(10, exponent(random)), .free = true};
      q.tolerance = std::abs(mantissa(random)) + 1e-6;
      const std::string text = write_quantity(q, dimension, units);
      CAPTURE(text);
      const Quantity back = read(text.c_str(), dimension);
      REQUIRE(std::abs(back.value - q.value) <= 2.3e-16 * std::abs(q.value));
      REQUIRE(std::abs(*back.tolerance - *q.tolerance) <= 2.3e-16 * *q.tolerance);
      if (dimension == length || dimension == number) REQUIRE(back.value == q.value);
      const std::string second = write_quantity(back, dimension, units);  // from here on it stays
      REQUIRE(read(second.c_str(), dimension).value == back.value);
    }
  }
}
