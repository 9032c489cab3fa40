#include "framework/diagnosis/formula_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/dsl/read.h"
#include "framework/kinematics/tape_values.h"

namespace talus {
namespace {

using Set = ShapeSetting::Kind;
using On = Shape::On;
using Eigen::MatrixXd, Eigen::VectorXd;

constexpr int kLeastSide = 4;         // poses on either side of a jump, or where something is local
constexpr double kMostCycles = 12;    // over the range, as many as the finest free curve follows
constexpr double kLeastCycles = 0.5;  // less is a polynomial
constexpr double kFine = 0.125;       // steps of cycles

// From a to b in equal ratios.
std::vector<double> ratios(double a, double b, int count) {
  std::vector<double> all;
  for (int i = 0; i < count; ++i) all.push_back(a * std::pow(b / a, i / (count - 1.0)));
  return all;
}

std::vector<double> cycles() {
  std::vector<double> all;
  for (double c = kLeastCycles; c <= kMostCycles; c += kFine) all.push_back(c);
  return all;
}

}  // namespace

const std::vector<Shape>& formula_shapes() {
  static const std::vector<Shape> shapes{
      {"line", {"size"}, {{"span", Set::span}}, "$size * ($x / $span)"},
      {"square", {"size"}, {{"span", Set::span}}, "$size * ($x / $span)^2"},
      {"cube", {"size"}, {{"span", Set::span}}, "$size * ($x / $span)^3"},
      {"fourth power", {"size"}, {{"span", Set::span}}, "$size * ($x / $span)^4"},
      {"fifth power", {"size"}, {{"span", Set::span}}, "$size * ($x / $span)^5"},
      {"modulus", {"size"}, {{"span", Set::span}}, "$size * abs($x / $span)", "kink", On::crossing},
      {"power 1.5",
       {"size"},
       {{"span", Set::span}},
       "$size * abs($x / $span) * sqrt(abs($x / $span) + 1e-9)"},
      {"root", {"size"}, {{"span", Set::span}}, "$size * sqrt(abs($x / $span) + 1e-9)"},
      {"sign", {"step"}, {}, "$step * less(0, $x)", "step", On::crossing},
      {"kink",
       {"size"},
       {{"centre", Set::centre}, {"span", Set::span}},
       "$size * abs(($x - $centre) / $span)"},
      {"step", {"step"}, {{"edge", Set::split}}, "$step * less($edge, $x)"},
      {"smooth step",
       {"height"},
       {{"centre", Set::centre}, {"width", Set::width}},
       "$height * (1 - 2 / (exp(2 * ($x - $centre) / $width) + 1))"},
      {"arctangent",
       {"height"},
       {{"centre", Set::centre}, {"width", Set::width}},
       "$height * atan2($x - $centre, $width) * 2 / pi"},
      {"Gaussian bump",
       {"height"},
       {{"centre", Set::centre}, {"width", Set::width}},
       "$height * exp(-(($x - $centre) / $width)^2 / 2)"},
      {"resonance",
       {"height"},
       {{"centre", Set::centre}, {"width", Set::width}},
       "$height / (1 + (($x - $centre) / $width)^2)"},
      {"harmonic",
       {"sine", "cosine"},
       {{"order", Set::whole}},
       "$sine * sin($order * $x) + $cosine * cos($order * $x)",
       "sinusoid",
       On::turning},
      {"sinusoid",
       {"sine", "cosine"},
       {{"order", Set::order}},
       "$sine * sin($order * $x) + $cosine * cos($order * $x)",
       "",
       On::turning},
      {"sinusoid",
       {"sine", "cosine"},
       {{"period", Set::period}},
       "$sine * sin(2 * pi * $x / $period) + $cosine * cos(2 * pi * $x / $period)",
       "",
       On::straight},
      {"exponential",
       {"size"},
       {{"scale", Set::scale}, {"start", Set::from}},
       "$size * exp(-($x - $start) / $scale)"},
      {"logarithm",
       {"size"},
       {{"scale", Set::width}, {"start", Set::from}},
       "$size * log(1 + ($x - $start) / $scale)",
       "",
       On::time},
  };
  return shapes;
}

ShapeValues::ShapeValues(const Shape& shape)
    : amounts_(shape.amounts.size()), settings_(shape.settings.size()) {
  std::string text = "effect \"shape\" { acts = \"reading\",\n";
  for (const std::string& a : shape.amounts)
    text += fmt::format("{} = amount(number, 1, \"amount\"),\n", a);
  for (const ShapeSetting& s : shape.settings)
    text += fmt::format("{} = setting(number, 1, \"setting\"),\n", s.name);
  text += "value = function(around, p) return " +
          named(shape.lua,
                [](const std::string& n) { return n == "x" ? "around.reading" : "p." + n; }) +
          " end }\n";
  Registry registry;
  run_lua_plugins(text, shape.name, registry);
  plugin_ = std::make_shared<const Plugin>(*registry.find("shape", Family::effect));
}

MatrixXd ShapeValues::operator()(const VectorXd& x, const std::vector<double>& settings) const {
  Tape tape;
  Around<Expr> around;
  around.reading = Expr::leaf(tape, 0);
  std::vector<Expr> inputs(amounts_ + settings_);
  for (std::size_t i = 0; i < settings_; ++i) inputs[amounts_ + i] = Expr(settings[i]);
  std::vector<std::int32_t> nodes;
  for (std::size_t a = 0; a < amounts_; ++a) {
    for (std::size_t i = 0; i < amounts_; ++i) inputs[i] = Expr(i == a ? 1 : 0);
    nodes.push_back(plugin_->act(around, inputs, {})[0].node_on(tape));
  }
  TapeValues values(tape, nodes);
  MatrixXd phi(x.size(), static_cast<Eigen::Index>(amounts_));
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const std::vector<double>& v = values(std::span<const double>(&x[k], 1));
    for (std::size_t a = 0; a < amounts_; ++a)
      phi(k, static_cast<Eigen::Index>(a)) = std::isfinite(v[a]) ? v[a] : 0;
  }
  return phi;
}

bool suits(const Shape& shape, Dimension dimension, const VectorXd& x) {
  switch (shape.on) {
    case On::any:
      return true;
    case On::turning:
      return dimension == angle;
    case On::straight:
      return !(dimension == angle);
    case On::time:
      return dimension == duration;
    case On::crossing:
      return (x.array() < 0).count() >= kLeastSide && (x.array() > 0).count() >= kLeastSide;
  }
  return false;
}

std::vector<double> tries(const ShapeSetting& setting, Dimension dimension,
                          const std::vector<double>& sorted) {
  const double low = sorted.front(), high = sorted.back(), range = high - low;
  std::vector<double> all;
  switch (setting.kind) {
    case Set::centre:
      for (int i = 1; i < 32; ++i) all.push_back(low + range * i / 32);
      break;
    case Set::split: {
      const std::size_t last = sorted.size() - kLeastSide;
      const std::size_t stride = std::max<std::size_t>(1, sorted.size() / 200);
      for (std::size_t i = kLeastSide; i <= last && i < sorted.size(); i += stride)
        if (sorted[i] > sorted[i - 1]) all.push_back((sorted[i] + sorted[i - 1]) / 2);
      break;
    }
    case Set::width:
      all = ratios(range / 32, range / 2, 9);
      break;
    case Set::scale:
      all = ratios(range / 16, range, 9);
      for (int i = 8; i >= 0; --i)
        all.push_back(-ratios(range / 16, range, 9)[static_cast<std::size_t>(i)]);
      std::sort(all.begin(), all.end());
      break;
    case Set::order:
      for (const double c : cycles()) all.push_back(2 * std::numbers::pi * c / range);
      break;
    case Set::whole:
      for (int n = 1; n * range / (2 * std::numbers::pi) <= kMostCycles && n <= 360; ++n)
        all.push_back(n);
      break;
    case Set::period:
      for (const double c : cycles()) all.push_back(range / c);
      std::sort(all.begin(), all.end());
      break;
    case Set::span: {
      const double most = std::max(std::abs(low), std::abs(high));
      const Unit unit = UnitSystem{}.of(dimension);
      const double round = std::pow(10, std::floor(std::log10(most / unit.factor)) - 1);
      all = {std::ceil(most / unit.factor / round) * round * unit.factor};
      break;
    }
    case Set::from:
      all = {low};
      break;
  }
  return all;
}

}  // namespace talus
