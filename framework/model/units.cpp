#include "framework/model/units.h"

#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "framework/model/error.h"

namespace talus {
namespace {

const std::vector<Unit>& base_units() {
  static const std::vector<Unit> units{
      {"mm", length, 1},
      {"m", length, 1000},
      {"um", length, 1e-3},
      {"cm", length, 10},
      {"in", length, 25.4},
      {"deg", angle, deg},
      {"rad", angle, 1},
      {"mrad", angle, 1e-3},
      {"arcmin", angle, deg / 60},
      {"arcsec", angle, deg / 3600},
      {"s", duration, 1},
      {"ms", duration, 1e-3},
      {"min", duration, 60},
      {"h", duration, 3600},
      {"degC", temperature, 1},
      {"K", temperature, 1, -273.15},
      {"kg", mass, 1},
      {"g", mass, 1e-3},
      {"N", force, 1000},
      {"count", count, 1},
  };
  return units;
}

constexpr Dimension acceleration{{1, 0, -2, 0, 0, 0}};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// product = power {("*" | "/" | space) power};  power = atom ["^" integer];
// atom = name | "1" | "(" product ")". A space is not allowed after a division: "deg/N m" could
// mean two things.
class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : text_(text) {}

  std::optional<Unit> parse() {
    std::optional<Unit> unit = product(0);
    if (!unit || at_ != text_.size()) return std::nullopt;
    unit->text = text_;
    return unit;
  }

 private:
  void skip_spaces() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  std::optional<Unit> product(int depth) {
    std::optional<Unit> left = power(depth);
    bool divided = false;
    while (left) {
      const std::size_t end = at_;
      skip_spaces();
      const char c = peek();
      if (c == '\0' || c == ')') break;
      if (c == '*' || c == '/') {
        ++at_;
        skip_spaces();
      } else if (at_ == end || divided) {
        return std::nullopt;
      }
      divided |= c == '/';
      std::optional<Unit> right = power(depth);
      if (!right) return std::nullopt;
      left = c == '/' ? combine(*left, *right, -1) : combine(*left, *right, 1);
    }
    return left;
  }

  std::optional<Unit> power(int depth) {
    std::optional<Unit> base = atom(depth);
    if (!base || peek() != '^') return base;
    ++at_;
    const bool negative = peek() == '-';
    if (negative) ++at_;
    if (!is_digit(peek())) return std::nullopt;
    const int exponent = (text_[at_++] - '0') * (negative ? -1 : 1);
    if (is_digit(peek())) return std::nullopt;
    return combine(Unit{}, *base, exponent);
  }

  std::optional<Unit> atom(int depth) {
    if (peek() == '(' && depth < 8) {
      ++at_;
      skip_spaces();
      std::optional<Unit> inner = product(depth + 1);
      skip_spaces();
      if (peek() != ')') return std::nullopt;
      ++at_;
      return inner;
    }
    if (peek() == '1') {
      ++at_;
      return is_digit(peek()) || is_letter(peek()) ? std::nullopt : std::optional<Unit>(Unit{});
    }
    const std::size_t start = at_;
    while (is_letter(peek())) ++at_;
    for (const Unit& unit : base_units())
      if (unit.text == text_.substr(start, at_ - start)) return unit;
    return std::nullopt;
  }

  // a * b^n, without offset: in a product a temperature is a difference.
  static std::optional<Unit> combine(const Unit& a, const Unit& b, int n) {
    Unit result{{}, a.dimension, a.factor * std::pow(b.factor, n)};
    for (std::size_t i = 0; i < a.dimension.powers.size(); ++i) {
      const int power = a.dimension.powers[i] + n * b.dimension.powers[i];
      if (std::abs(power) > 20) return std::nullopt;
      result.dimension.powers[i] = static_cast<signed char>(power);
    }
    return result;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

std::string_view trim(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

// "N*m/deg", "1/degC", "deg/(N*m)"
std::string write_product(const std::vector<std::pair<std::string, int>>& powers) {
  std::vector<std::string> over, under;
  for (const auto& [name, power] : powers) {
    const int n = std::abs(power);
    if (n > 0) (power > 0 ? over : under).push_back(n == 1 ? name : name + "^" + std::to_string(n));
  }
  std::string text = over.empty() ? "1" : join(over, "*");
  if (under.size() == 1) text += "/" + under[0];
  if (under.size() > 1) text += "/(" + join(under, "*") + ")";
  return text;
}

}  // namespace

Dimension operator*(Dimension a, Dimension b) {
  for (std::size_t i = 0; i < a.powers.size(); ++i) a.powers[i] += b.powers[i];
  return a;
}

Dimension operator/(Dimension a, Dimension b) {
  for (std::size_t i = 0; i < a.powers.size(); ++i) a.powers[i] -= b.powers[i];
  return a;
}

std::optional<Unit> parse_unit(std::string_view text) {
  text = trim(text);
  if (text.empty() || text.size() > 80) return std::nullopt;
  return UnitParser(text).parse();
}

std::vector<std::string> unit_names(std::optional<Dimension> dimension) {
  std::vector<std::string> names;
  for (const Unit& unit : base_units())
    if (!dimension || unit.dimension == *dimension) names.push_back(unit.text);
  return names;
}

std::string nearest_unit(std::string_view text, std::optional<Dimension> dimension) {
  static const std::pair<std::string_view, const char*> meant[] = {
      {"°", "deg"},          {"degree", "deg"},   {"degrees", "deg"},   {"°C", "degC"},
      {"C", "degC"},         {"celsius", "degC"}, {"kelvin", "K"},      {"µm", "um"},
      {"μm", "um"},          {"micron", "um"},    {"millimeter", "mm"}, {"millimetre", "mm"},
      {"millimeters", "mm"}, {"meter", "m"},      {"metre", "m"},       {"meters", "m"},
      {"inch", "in"},        {"radian", "rad"},   {"radians", "rad"},   {"sec", "s"},
      {"second", "s"},       {"seconds", "s"},    {"hour", "h"},        {"Nm", "N*m"},
      {"Nmm", "N*mm"},       {"newton", "N"},     {"m/s2", "m/s^2"},    {"m/s²", "m/s^2"},
      {"counts", "count"},   {"gram", "g"},
  };
  text = trim(text);
  if (text.empty()) return "";
  for (const auto& [wrong, right] : meant)
    if (text == wrong && (!dimension || parse_unit(right)->dimension == *dimension)) return right;
  const std::string near = dimension ? nearest(text, unit_names(dimension)) : "";
  return near.empty() && !dimension ? nearest(text, unit_names({})) : near;
}

std::string describe(Dimension dimension) {
  static const std::pair<Dimension, const char*> names[] = {
      {length, "a length"},           {angle, "an angle"}, {duration, "a time"}, {mass, "a mass"},
      {temperature, "a temperature"}, {count, "a count"},
  };
  for (const auto& [known, name] : names)
    if (known == dimension) return std::string(name) + " (" + join(unit_names(known)) + ")";
  if (dimension == number) return "a plain number (no unit)";
  if (dimension == force) return "a force (N)";
  if (dimension == torque) return "a torque (N*m, N*mm)";
  if (dimension == acceleration) return "an acceleration (m/s^2)";
  return "a quantity in " + UnitSystem{}.of(dimension).text;
}

Unit UnitSystem::of(Dimension dimension) const {
  if (dimension == talus::length) return length;
  if (dimension == talus::angle) return angle;
  if (dimension == acceleration) return *parse_unit("m/s^2");
  const auto& p = dimension.powers;
  int lengths = p[0], durations = p[2], masses = p[3], forces = 0;
  if (masses * durations < 0) {  // kg mm/s^2 reads better as N
    forces = std::exchange(masses, 0);
    lengths -= forces;
    durations += 2 * forces;
  }
  // A torque is in N*m whatever the model's lengths are in; N/mm and mm/N keep them.
  const std::string along = forces * lengths > 0 ? "m" : length.text;
  const std::string text = write_product({{"N", forces},
                                          {"kg", masses},
                                          {along, lengths},
                                          {angle.text, p[1]},
                                          {"s", durations},
                                          {"degC", p[4]},
                                          {"count", p[5]}});
  return parse_unit(text).value_or(Unit{text, dimension});
}

}  // namespace talus
