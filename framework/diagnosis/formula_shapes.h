// The library of elementary functions that a formula of unknown physics is put together from.
//
// A shape is a sum of amounts times functions of one circumstance, each amount in the unit of the
// correction; its settings (a centre, a width, an order) shape it. It is written in Lua, with $ in
// front of every name: what is scanned is then, word for word, the effect that is handed out.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "framework/model/units.h"
#include "framework/registry/plugin.h"

namespace talus {

struct ShapeSetting {
  enum class Kind {
    centre,  // where something happens: within the range
    split,   // the same, between two poses: the shape jumps there
    width,   // of something local: a thirtieth to half of the range
    scale,   // of a decay or growth, either sense where it is signed: a sixteenth to all of it
    order,   // per turn: half a period to twelve over the range
    whole,   // the same, whole numbers only
    period,  // as order, of what is no angle
    span,    // the largest of |x|: a unit of measure, not a quantity to be found
    from     // where the range begins: the same
  };
  std::string name;
  Kind kind;
  bool free() const { return kind != Kind::span && kind != Kind::from; }
  bool fitted() const { return free() && kind != Kind::split && kind != Kind::whole; }
};

struct Shape {
  std::string name;  // "Gaussian bump"
  std::vector<std::string> amounts;
  std::vector<ShapeSetting> settings;
  std::string lua;      // "$height * exp(-(($x - $centre) / $width)^2 / 2)"
  std::string special;  // name of the shape that this one is a special case of
  enum class On { any, turning, straight, time, crossing } on = On::any;  // crossing: zero inside
};

const std::vector<Shape>& formula_shapes();

// A shape's functions (one for each amount) at the poses' circumstances.
class ShapeValues {
 public:
  explicit ShapeValues(const Shape& shape);
  Eigen::MatrixXd operator()(const Eigen::VectorXd& x, const std::vector<double>& settings) const;

 private:
  std::shared_ptr<const Plugin> plugin_;
  std::size_t amounts_, settings_;
};

// Is it of use for a circumstance of this dimension that takes these values?
bool suits(const Shape& shape, Dimension dimension, const Eigen::VectorXd& x);
// Values of a setting to try, increasing; `sorted` are the circumstances. One where it is not free.
std::vector<double> tries(const ShapeSetting& setting, Dimension dimension,
                          const std::vector<double>& sorted);

// The text with every $name written as name(name).
template <class F>
std::string named(const std::string& text, F name) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '$') {
      out += text[i];
      continue;
    }
    std::size_t end = i + 1;
    while (end < text.size() && std::isalpha(static_cast<unsigned char>(text[end]))) ++end;
    out += name(text.substr(i + 1, end - i - 1));
    i = end - 1;
  }
  return out;
}

}  // namespace talus
