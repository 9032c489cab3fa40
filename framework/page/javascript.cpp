#include "framework/page/javascript.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "framework/kinematics/tape_values.h"

namespace talus {
namespace {

std::string number_text(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "Infinity" : "(-Infinity)";
  return std::signbit(value) ? fmt::format("({})", value) : fmt::format("{}", value);
}

std::string operation(Op op, const std::string& a, const std::string& b, const std::string& c) {
  switch (op) {
    case Op::add:
      return a + "+" + b;
    case Op::sub:
      return a + "-" + b;
    case Op::mul:
      return a + "*" + b;
    case Op::div:
      return a + "/" + b;
    case Op::neg:
      return "-" + a;
    case Op::sin:
      return "Math.sin(" + a + ")";
    case Op::cos:
      return "Math.cos(" + a + ")";
    case Op::tan:
      return "Math.tan(" + a + ")";
    case Op::asin:
      return "Math.asin(" + a + ")";
    case Op::acos:
      return "Math.acos(" + a + ")";
    case Op::atan2:
      return "Math.atan2(" + a + "," + b + ")";
    case Op::sqrt:
      return "Math.sqrt(" + a + ")";
    case Op::exp:
      return "Math.exp(" + a + ")";
    case Op::log:
      return "Math.log(" + a + ")";
    case Op::abs:
      return "Math.abs(" + a + ")";
    case Op::sign:
      return a + ">0?1:" + a + "<0?-1:0";
    case Op::less:
      return a + "<" + b + "?1:0";
    case Op::select:
      return a + "!==0?" + b + ":" + c;
    case Op::floor:
      return "Math.floor(" + a + ")";
    case Op::constant:
    case Op::leaf:
      break;
  }
  return a;
}

}  // namespace

std::string javascript(const Tape& tape, const std::vector<std::int32_t>& wanted) {
  std::string out = "function(s,o){";
  std::map<std::int32_t, std::string> name;                  // a constant's is the number
  for (const std::int32_t i : needed_nodes(tape, wanted)) {  // arguments stand before their users
    const Node& n = tape[i];
    if (n.op == Op::constant) {
      name[i] = number_text(n.value);
      continue;
    }
    auto argument = [&](std::int32_t a) { return a >= 0 ? name.at(a) : std::string(); };
    name[i] = fmt::format("v{}", name.size());
    out += "const " + name[i] + "=" +
           (n.op == Op::leaf ? fmt::format("s[{}]", n.a)
                             : operation(n.op, argument(n.a), argument(n.b), argument(n.c))) +
           ";\n";
  }
  for (std::size_t i = 0; i < wanted.size(); ++i)
    out += fmt::format("o[{}]={};\n", i, name.at(wanted[i]));
  return out + "}";
}

}  // namespace talus
