#include "framework/model/quantity.h"

#include <limits>

#include "framework/model/digits.h"

namespace talus {
namespace {

constexpr std::string_view signs_of_tolerance[] = {"±", "+-", "+/-"};
constexpr std::string_view unicode_minus = "−";

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

// The length of the number at the start of `text`, 0 where there is none.
std::size_t number_length(std::string_view text) {
  std::size_t at = 0;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) ++at;
  if (text.starts_with(unicode_minus)) at = unicode_minus.size();
  const std::size_t digits = at;
  while (at < text.size() && (is_digit(text[at]) || text[at] == '.')) ++at;
  if (at == digits || text.substr(digits, at - digits) == ".") return 0;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    std::size_t end = at + 1;
    if (end < text.size() && (text[end] == '+' || text[end] == '-')) ++end;
    if (end < text.size() && is_digit(text[end]))
      for (at = end; at < text.size() && is_digit(text[at]);) ++at;
  }
  return at;
}

std::size_t tolerance_sign_length(std::string_view text) {
  for (std::string_view sign : signs_of_tolerance)
    if (text.starts_with(sign)) return sign.size();
  return 0;
}

// What stands before the next sign of the grammar.
std::string_view unit_text(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size() && std::string_view("?[],+").find(text[end]) == std::string_view::npos &&
         tolerance_sign_length(text.substr(end)) == 0)
    ++end;
  return text.substr(0, end);
}

struct Written {  // one number, as it stands
  double value = 0;
  std::string_view text;
  std::optional<Unit> unit;
};

class Parser {
 public:
  Parser(std::string_view text, Dimension dimension, const UnitSystem& units, const Place& place)
      : text_(text), dimension_(dimension), units_(units), place_(place) {}

  Quantity parse() {
    if (trim(text_).empty())
      fail(0, "there is no number here", "a number, such as 300 or 300 ± 0.5");
    Quantity quantity;
    Written value = number("a number, such as 300 or 300 ± 0.5");
    std::optional<Written> tolerance, lower, upper;
    if (skip("?")) {
      quantity.free = true;
    } else if (std::size_t n = tolerance_sign_length(text_.substr(at_))) {
      at_ += n;
      quantity.free = true;
      tolerance = number("a tolerance after '±'");
      if (!(tolerance->value > 0))
        fail(start(*tolerance),
             "the tolerance " + std::string(tolerance->text) + " is not positive",
             "a positive tolerance, or the number alone where it is fixed");
      if (text_.substr(at_).starts_with('?'))
        fail(at_, "'?' after a tolerance", "either '± tolerance' or '?'");
    }
    const std::size_t bracket = at_;
    std::optional<Unit> last;
    if (skip("[")) {
      lower = number("the lower bound, as in [290, 310]", true);
      if (!skip(",")) fail(at_, found_here(), "',' and the upper bound, as in [290, 310]");
      upper = number("the upper bound, as in [290, 310]", true);
      if (!skip("]")) fail(at_, found_here(), "']' after the two bounds; decimals have a point");
      last = unit();
    }
    if (at_ < text_.size()) fail(at_, found_here(), "nothing more after '" + before() + "'");

    const Unit fallback = units_.of(dimension_);
    if (!value.unit && tolerance) value.unit = tolerance->unit;
    if (!value.unit && lower) value.unit = lower->unit ? lower->unit : upper->unit;
    if (!value.unit) value.unit = last ? last : fallback;
    auto internal = [&](const Written& w) {
      const Unit& own = w.unit ? *w.unit : *value.unit;
      return own.factor * w.value + own.offset;
    };
    quantity.value = internal(value);
    if (tolerance) {
      tolerance->value *= (tolerance->unit ? *tolerance->unit : *value.unit).factor;
      quantity.tolerance = tolerance->value;
    }
    if (lower) {
      quantity.bounds = {internal(*lower), internal(*upper)};
      const std::string range =
          "[" + std::string(lower->text) + ", " + std::string(upper->text) + "]";
      if (!(quantity.bounds->first < quantity.bounds->second))
        fail(bracket, "the bounds " + range + " hold no number",
             "the lower bound first, then a larger one");
      if (quantity.value < quantity.bounds->first || quantity.value > quantity.bounds->second)
        fail(start(value), std::string(value.text) + " is out of its bounds " + range,
             "a number within them");
    }
    return quantity;
  }

 private:
  [[noreturn]] void fail(std::size_t at, const std::string& found, const std::string& expected,
                         const std::string& suggestion = {}) const {
    Place place = place_;
    if (place.column > 0)  // characters, not bytes
      for (char c : text_.substr(0, at)) place.column += (c & 0xC0) != 0x80;
    throw InputError(place, found, expected, suggestion);
  }

  std::size_t start(const Written& w) const { return w.text.data() - text_.data(); }
  std::string before() const { return std::string(trim(text_.substr(0, at_))); }
  std::string found_here() const {
    const std::string_view rest = trim(text_.substr(at_));
    return rest.empty() ? "the text ends after '" + before() + "'"
                        : "'" + std::string(rest) + "' is left over";
  }

  void skip_spaces() {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  }
  bool skip(std::string_view what) {
    if (!text_.substr(at_).starts_with(what)) return false;
    at_ += what.size();
    skip_spaces();
    return true;
  }

  // A number and, if it follows, its unit.
  Written number(const std::string& expected, bool infinite = false) {
    skip_spaces();
    std::string_view rest = text_.substr(at_);
    Written written;
    const std::size_t sign = rest.starts_with('-') || rest.starts_with('+') ? 1 : 0;
    std::size_t n = number_length(rest);
    if (infinite && rest.substr(sign).starts_with("inf")) {
      n = sign + 3;
      written.value = std::numeric_limits<double>::infinity() * (rest[0] == '-' ? -1 : 1);
    } else if (n == 0) {
      fail(at_, rest.empty() ? found_here() : "'" + std::string(trim(rest)) + "' is not a number",
           expected);
    } else {
      written.value = value(rest.substr(0, n));
    }
    written.text = rest.substr(0, n);
    at_ += n;
    if (!infinite && at_ + 1 < text_.size() && text_[at_] == ',' && is_digit(text_[at_ + 1]))
      decimal_comma(written);
    skip_spaces();
    written.unit = unit();
    return written;
  }

  double value(std::string_view digits) const {
    if (digits.starts_with(unicode_minus))
      fail(at_, "'" + std::string(digits) + "' has a typographic minus sign", "a number",
           "-" + std::string(digits.substr(unicode_minus.size())));
    std::string_view rest = digits.substr(digits[0] == '+' ? 1 : 0);
    double value = 0;
    const auto [length, error] = read_digits(rest, value);
    if (error == std::errc::result_out_of_range)
      fail(at_, "'" + std::string(digits) + "' is too large or too small for a number",
           "a smaller exponent");
    if (error != std::errc() || length != rest.size())
      fail(at_, "'" + std::string(digits) + "' is not a number", "digits with one decimal point");
    return value;
  }

  [[noreturn]] void decimal_comma(const Written& written) const {
    std::size_t end = at_ + 1;
    while (end < text_.size() && is_digit(text_[end])) ++end;
    const std::string whole(written.text), decimals(text_.substr(at_ + 1, end - at_ - 1));
    fail(at_, "'" + whole + "," + decimals + "' has a decimal comma", "a decimal point",
         whole + "." + decimals);
  }

  std::optional<Unit> unit() {
    const std::string_view raw = unit_text(text_.substr(at_));
    const std::string_view name = trim(raw);
    if (name.empty()) return std::nullopt;
    const bool second_number = is_digit(name[0]) && !name.starts_with("1/");
    if (second_number) fail(at_, found_here(), "nothing more after '" + before() + "'");
    const std::optional<Unit> unit = parse_unit(name);
    const std::string quoted = "'" + std::string(name) + "'";
    if (!unit)
      fail(at_, quoted + " is not a unit", describe(dimension_), nearest_unit(name, dimension_));
    if (unit->dimension != dimension_) {
      const std::string what = describe(unit->dimension);
      fail(at_, quoted + " measures " + what.substr(0, what.find(" (")), describe(dimension_));
    }
    at_ += raw.size();
    return unit;
  }

  std::string_view text_;
  Dimension dimension_;
  const UnitSystem& units_;
  Place place_;
  std::size_t at_ = 0;
};

}  // namespace

bool looks_like_quantity(std::string_view text) {
  text = trim(text);
  const std::size_t n = number_length(text);
  if (n == 0) return false;
  const std::string_view rest = trim(text.substr(n));
  if (rest.empty() || rest[0] == ',' || rest[0] == '?' || rest[0] == '[') return true;
  if (std::size_t sign = tolerance_sign_length(rest))  // "2 +-x" is a sum
    return rest.starts_with("±") || number_length(trim(rest.substr(sign))) > 0;
  if (std::string_view("+-*/^()").find(rest[0]) != std::string_view::npos) return false;
  const std::string_view name = unit_text(rest);
  const std::string_view after = rest.substr(name.size());
  if (!after.empty() && (after[0] == '?' || after[0] == '[' || tolerance_sign_length(after) > 0))
    return true;
  return (after.empty() && parse_unit(name)) ||
         rest.find_first_of("+-*/^()") == std::string_view::npos;
}

Quantity parse_quantity(std::string_view text, Dimension dimension, const UnitSystem& units,
                        const Place& place) {
  return Parser(text, dimension, units, place).parse();
}

}  // namespace talus
