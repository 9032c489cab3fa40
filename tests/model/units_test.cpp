#include "framework/model/units.h"

#include <doctest/doctest.h>

#include <numbers>

using namespace talus;

TEST_CASE("base units are converted to mm, rad, s, kg, degC") {
  const auto factor = [](const char* text) { return parse_unit(text).value().factor; };
  CHECK(factor("mm") == 1);
  CHECK(factor("m") == 1000);
  CHECK(factor("um") == 1e-3);
  CHECK(factor("cm") == 10);
  CHECK(factor("in") == 25.4);
  CHECK(factor("deg") == doctest::Approx(std::numbers::pi / 180).epsilon(1e-15));
  CHECK(factor("rad") == 1);
  CHECK(factor("mrad") == 1e-3);
  CHECK(factor("arcmin") * 60 == doctest::Approx(deg).epsilon(1e-15));
  CHECK(factor("arcsec") * 3600 == doctest::Approx(deg).epsilon(1e-15));
  CHECK(factor("ms") == 1e-3);
  CHECK(factor("min") == 60);
  CHECK(factor("h") == 3600);
  CHECK(factor("g") == 1e-3);
  CHECK(factor("N") == 1000);  // kg mm/s^2
  CHECK(factor("count") == 1);
  CHECK(factor("1") == 1);
}

TEST_CASE("kelvin has an offset on its own, none in a product") {
  CHECK(parse_unit("K")->offset == -273.15);
  CHECK(parse_unit("degC")->offset == 0);
  CHECK(parse_unit("1/K")->offset == 0);
  CHECK(parse_unit("mm*K")->offset == 0);
}

TEST_CASE("products of units") {
  const auto is = [](const char* text, Dimension dimension, double factor) {
    CAPTURE(text);
    const auto unit = parse_unit(text);
    REQUIRE(unit);
    CHECK(unit->dimension == dimension);
    CHECK(unit->factor == doctest::Approx(factor).epsilon(1e-14));
  };
  is("N*m", torque, 1e6);
  is("N m", torque, 1e6);
  is("deg/(N*m)", angle / torque, deg / 1e6);
  is("deg / (N m)", angle / torque, deg / 1e6);
  is("mm/mm", number, 1);
  is("mm/m", number, 1e-3);
  is("1/degC", number / temperature, 1);
  is("m/s^2", length / duration / duration, 1000);
  is("m*s^-2", length / duration / duration, 1000);
  is("kg*mm^2", mass * length * length, 1);
  is("N/mm*mm", force, 1000);
  is("((mm))", length, 1);
}

TEST_CASE("what is no unit") {
  for (const char* text : {"",     " ",       "mmm",       "MM",          "Deg",  "kmm", "N*",
                           "/mm",  "mm)",     "(mm",       "mm^",         "m^10", "11",  "1mm",
                           "mm 2", "deg/N m", "deg/N*m s", "m^9*m^9*m^9", "°",    "mm,", "%"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_unit(text));
  }
  CHECK_FALSE(parse_unit(std::string(100000, '(')));
}

TEST_CASE("the canonical unit of a dimension") {
  const UnitSystem mm_deg;
  CHECK(mm_deg.of(number).text == "1");
  CHECK(mm_deg.of(length).text == "mm");
  CHECK(mm_deg.of(angle).text == "deg");
  CHECK(mm_deg.of(temperature).text == "degC");
  CHECK(mm_deg.of(force).text == "N");
  CHECK(mm_deg.of(torque).text == "N*m");
  CHECK(mm_deg.of(angle / torque).text == "deg/(N*m)");
  CHECK(mm_deg.of(length / force).text == "mm/N");
  CHECK(mm_deg.of(force / length).text == "N/mm");
  CHECK(mm_deg.of(number / temperature).text == "1/degC");
  CHECK(mm_deg.of(length / duration / duration).text == "m/s^2");
  CHECK(mm_deg.of(mass * length * length).text == "kg*mm^2");
  const UnitSystem m_rad{*parse_unit("m"), *parse_unit("rad")};
  CHECK(m_rad.of(length).text == "m");
  CHECK(m_rad.of(angle / torque).text == "rad/(N*m)");
  CHECK(m_rad.of(length / force).text == "m/N");
}

TEST_CASE("a canonical unit has the dimension it was asked for, whatever that is") {
  const UnitSystem units;
  for (int code = 0; code < 5 * 5 * 5 * 5 * 3; ++code) {
    int rest = code;
    Dimension dimension;
    for (int i : {0, 1, 2, 3, 4}) {
      const int n = i == 4 ? 3 : 5;
      dimension.powers[i] = static_cast<signed char>(rest % n - n / 2);
      rest /= n;
    }
    const Unit unit = units.of(dimension);
    CAPTURE(unit.text);
    REQUIRE(unit.dimension == dimension);
    REQUIRE(parse_unit(unit.text)->factor == unit.factor);
  }
}

TEST_CASE("words for messages") {
  CHECK(describe(length) == "a length (mm, m, um, cm, in)");
  CHECK(describe(angle) == "an angle (deg, rad, mrad, arcmin, arcsec)");
  CHECK(describe(number) == "a plain number (no unit)");
  CHECK(describe(angle / torque) == "a quantity in deg/(N*m)");
  CHECK(nearest_unit("°C") == "degC");
  CHECK(nearest_unit("degrees") == "deg");
  CHECK(nearest_unit("mmm") == "mm");
  CHECK(nearest_unit("µm") == "um");
  CHECK(nearest_unit("Nm") == "N*m");
  CHECK(nearest_unit("Nm", length) != "N*m");
  CHECK(nearest_unit("furlong") == "");
}
