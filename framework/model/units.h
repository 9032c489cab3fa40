// Units and dimensions. Inside the framework every number is in mm, rad, s, kg, degC (and their
// products); units exist only where text is read or written.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace talus {

// Exponents of length, angle, duration, mass, temperature, count.
struct Dimension {
  std::array<signed char, 6> powers{};
  friend bool operator==(const Dimension&, const Dimension&) = default;
};
Dimension operator*(Dimension a, Dimension b);
Dimension operator/(Dimension a, Dimension b);

inline constexpr Dimension number{};
inline constexpr Dimension length{{1, 0, 0, 0, 0, 0}};
inline constexpr Dimension angle{{0, 1, 0, 0, 0, 0}};
inline constexpr Dimension duration{{0, 0, 1, 0, 0, 0}};
inline constexpr Dimension mass{{0, 0, 0, 1, 0, 0}};
inline constexpr Dimension temperature{{0, 0, 0, 0, 1, 0}};
inline constexpr Dimension count{{0, 0, 0, 0, 0, 1}};
inline constexpr Dimension force{{1, 0, -2, 1, 0, 0}};
inline constexpr Dimension torque{{2, 0, -2, 1, 0, 0}};

inline constexpr double deg = 0.017453292519943295;  // rad

// internal = factor * written + offset (the offset only for a temperature column in K).
struct Unit {
  std::string text;
  Dimension dimension;
  double factor = 1;
  double offset = 0;
};

// mm m um cm in deg rad mrad arcmin arcsec s ms min h degC K kg g N count 1, with a prefix-free
// algebra of * / ^ and parentheses, e.g. "deg/(N*m)"; "N m" is "N*m". Nothing else.
std::optional<Unit> parse_unit(std::string_view text);

// "a length (mm, m, ...)": for messages.
std::string describe(Dimension dimension);

// For messages: the names that parse_unit knows, and the one nearest to what was written ("°C" is
// meant as "degC"), or "". With a dimension, only units of that.
std::vector<std::string> unit_names(std::optional<Dimension> dimension = {});
std::string nearest_unit(std::string_view text, std::optional<Dimension> dimension = {});

// The units in which one model is written and reported. Lengths and angles are the model's choice,
// everything else has one canonical unit.
struct UnitSystem {
  Unit length{"mm", talus::length, 1, 0};
  Unit angle{"deg", talus::angle, deg, 0};
  Unit of(Dimension dimension) const;  // e.g. "mm", "deg", "1", "deg/(N*m)"
};

}  // namespace talus
