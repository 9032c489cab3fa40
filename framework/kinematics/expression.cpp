#include "framework/kinematics/expression.h"

#include <fmt/format.h>

#include <cctype>
#include <vector>

#include "framework/model/digits.h"

namespace talus {
namespace {

class Parser {
 public:
  Parser(std::string_view text, const Place& place, const Resolve& resolve)
      : text_(text), place_(place), resolve_(resolve) {}

  Term all() {
    Term term = sum();
    if (!done())
      fail(fmt::format("unexpected '{}' in expression '{}'", text_[at_], text_),
           "an operator + - * / ^ or the end");
    return term;
  }

 private:
  Place here() const {
    Place p = place_;
    if (p.column > 0) p.column += static_cast<int>(at_);
    return p;
  }
  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw InputError(here(), found, expected);
  }
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  bool done() {
    skip();
    return at_ >= text_.size();
  }
  char peek() { return done() ? '\0' : text_[at_]; }
  bool take(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }

  Term sum() {
    Term left = product();
    for (char c = peek(); c == '+' || c == '-'; c = peek()) {
      const Place where = here();
      ++at_;
      Term right = product();
      if (!(left.dimension == right.dimension))
        throw InputError(where,
                         fmt::format("'{}' joins {} and {} in '{}'", c, describe(left.dimension),
                                     describe(right.dimension), text_),
                         "two of a kind; write the unit of a number, such as 90 deg");
      left.value = c == '+' ? left.value + right.value : left.value - right.value;
    }
    return left;
  }

  Term product() {
    Term left = factor();
    for (char c = peek(); c == '*' || c == '/'; c = peek()) {
      ++at_;
      Term right = factor();
      left = c == '*' ? Term{left.value * right.value, left.dimension * right.dimension}
                      : Term{left.value / right.value, left.dimension / right.dimension};
    }
    return left;
  }

  Term factor() {
    if (take('-')) {
      Term t = factor();
      return {-t.value, t.dimension};
    }
    Term base = atom();
    if (!take('^')) return base;
    const double exponent = literal();
    if (exponent != int(exponent) || exponent < 1 || exponent > 9)
      fail(fmt::format("exponent {}", exponent), "a whole number from 1 to 9");
    Term result = base;
    for (int i = 1; i < int(exponent); ++i)
      result = {result.value * base.value, result.dimension * base.dimension};
    return result;
  }

  double literal() {
    skip();
    double value = 0;
    const auto [length, error] = read_digits(text_.substr(at_), value);
    if (error != std::errc()) fail(fmt::format("'{}'", text_.substr(at_)), "a number");
    at_ += length;
    return value;
  }

  std::string word() {
    const std::size_t start = at_;
    auto good = [&](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.';
    };
    while (at_ < text_.size() && good(text_[at_])) ++at_;
    return std::string(text_.substr(start, at_ - start));
  }

  Term atom() {
    const char c = peek();
    if (take('(')) {
      Term inner = sum();
      if (!take(')')) fail(fmt::format("'(' is not closed in '{}'", text_), "')'");
      return inner;
    }
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') {
      const double value = literal();
      if (!std::isalpha(static_cast<unsigned char>(peek()))) return {value, number};
      const Place where = here();
      const std::string unit_text = word();
      auto unit = parse_unit(unit_text);
      if (!unit)
        throw InputError(where, fmt::format("'{}' is not a unit", unit_text),
                         "a unit such as mm or deg");
      return {unit->factor * value, unit->dimension};
    }
    if (std::isalpha(static_cast<unsigned char>(c)) || c == '_') {
      const Place where = here();
      const std::string name = word();
      return take('(') ? function(name, where) : resolve_(name, where);
    }
    fail(c ? fmt::format("'{}' in expression '{}'", c, text_)
           : fmt::format("expression '{}' ends early", text_),
         "a number, a name or '('");
  }

  Term function(const std::string& name, const Place& where) {
    std::vector<Term> a{sum()};
    while (take(',')) a.push_back(sum());
    if (!take(')')) fail(fmt::format("'(' of {} is not closed", name), "')'");
    auto need = [&](std::size_t count, Dimension dimension) {
      if (a.size() != count)
        throw InputError(where,
                         fmt::format("{} takes {} arguments, found {}", name, count, a.size()));
      for (const Term& t : a)
        if (!(t.dimension == dimension))
          throw InputError(where, fmt::format("{} of {}", name, describe(t.dimension)),
                           describe(dimension));
    };
    if (name == "sin") return need(1, angle), Term{sin(a[0].value), number};
    if (name == "cos") return need(1, angle), Term{cos(a[0].value), number};
    if (name == "tan") return need(1, angle), Term{tan(a[0].value), number};
    if (name == "asin") return need(1, number), Term{asin(a[0].value), angle};
    if (name == "acos") return need(1, number), Term{acos(a[0].value), angle};
    if (name == "sqrt") return need(1, number), Term{sqrt(a[0].value), number};
    if (name == "exp") return need(1, number), Term{exp(a[0].value), number};
    if (name == "log") return need(1, number), Term{log(a[0].value), number};
    if (name == "abs") return need(1, a[0].dimension), Term{abs(a[0].value), a[0].dimension};
    if (name == "sign") return need(1, a[0].dimension), Term{sign(a[0].value), number};
    if (name == "atan2")
      return need(2, a[0].dimension), Term{atan2(a[0].value, a.back().value), angle};
    if (name == "less")
      return need(2, a[0].dimension), Term{less(a[0].value, a.back().value), number};
    static const std::vector<std::string> names{"sin", "cos", "tan", "asin", "acos",  "sqrt",
                                                "exp", "log", "abs", "sign", "atan2", "less"};
    throw InputError(where, fmt::format("unknown function '{}'", name), "one of: " + join(names),
                     nearest(name, names));
  }

  std::string_view text_;
  const Place& place_;
  const Resolve& resolve_;
  std::size_t at_ = 0;
};

}  // namespace

Term parse_expression(std::string_view text, const Place& place, const Resolve& resolve) {
  return Parser(text, place, resolve).all();
}

}  // namespace talus
