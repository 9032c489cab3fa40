// What a plugin is. One file, one struct: a declaration (said once, from which parsing, checking,
// units, messages, schema, Lua constructors and docs are made) and the mathematics, a template on
// the scalar type.
//
//     struct Dh {
//       static Declaration declaration() {
//         return joint("dh", "Denavit-Hartenberg joint, distal form (Bonny 2013, sec. 2.1)")
//             .coordinate("theta", angle, "rotation about z of A")
//             .input("d", length, 0, "offset along z of A") ...;
//       }
//       template <class T> static Rigid<T> transform(T theta, T d, T a, T alpha) { ... }
//     };
//     TALUS_PLUGIN(Dh)
//
// The families and the function each must have (inputs in the order declared, then one `int` per
// choice: the index of the chosen word):
//     joint    Rigid<T> transform(T inputs...)            T_A_B, A the frame before the joint
//     sensor   T value(T reading, T inputs...)            the coordinate that a reading means
//     feature  Rigid<T> offset(T inputs...)               from the frame to the feature (optional)
//              Observed<T> observe(T columns..., int choices...)   from the measured columns
//     residual std::vector<T> rows(const Rigid<T>& model, const Observed<T>& measured, T inputs...)
//                                                         measured minus modelled, per declared row
//     shape    std::vector<T> deviations(T x, T y, T z, T radius)   of a probed point, given in the
//                                                         shape's own frame: origin on it, axis z
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "framework/kinematics/rigid.h"
#include "framework/model/units.h"

namespace talus {

enum class Family { joint, sensor, feature, residual, shape };
std::string to_string(Family family);

// What a feature observes and a residual can work on.
enum class Kind { frame, point, direction, scalar, nothing };
std::string to_string(Kind kind);

// How the order of its points gives a shape's axis its sense: along it from first to last, or about
// it by the right-hand rule. None: the shape has no axis.
enum class Sense { none, along, around };

template <class T>
struct Observed {
  Kind kind = Kind::nothing;
  Rigid<T> frame;       // T_in_feature: whole for a frame, translation only for a point
  Vector3<T> vector{};  // direction: unit vector; for inverse direction cosines as measured: angles
  T scalar{};           // scalar
  bool angles = false;  // direction given by its three angles to the axes rather than by components
};

struct Input {
  std::string name;
  Dimension dimension;
  double otherwise = 0;     // default, internal units
  bool coordinate = false;  // moves from pose to pose; must be given
  bool required = false;
  std::string meaning;
};

struct Choice {
  std::string name;
  std::vector<std::string> words;  // the first is the default
  std::string meaning;
};

// A measured column (features) or a row of residuals.
struct Column {
  std::string suffix;  // features: appended to the `columns` prefix; residuals: the measure's name
  Dimension dimension;
};

struct Declaration {
  Family family = Family::joint;
  std::string tag;
  std::string summary;  // one line; ends with the source (paper, equation) where there is one
  std::vector<Input> inputs;
  std::vector<Choice> choices;
  std::vector<Column> columns;         // features: measured columns; residuals: rows
  std::vector<Kind> kinds;             // features: the one observed; residuals: those accepted
  std::vector<std::string> residuals;  // features: those taken where the model names none
  Dimension reading = number, value = number;  // sensors
  int freedom = 0;                             // shapes: how many numbers fix one; fewest points
  int points = 0;
  Sense sense = Sense::none;
  bool dependent = false;  // residuals: a frame's or direction's rows follow from one another
  bool lua = false;

  Declaration& coordinate(std::string name, Dimension dimension, std::string meaning);
  Declaration& input(std::string name, Dimension dimension, double otherwise, std::string meaning);
  Declaration& required(std::string name, Dimension dimension, std::string meaning);
  Declaration& choice(std::string name, std::vector<std::string> words, std::string meaning);
  Declaration& column(std::string suffix, Dimension dimension);
  Declaration& judged_by(std::vector<std::string> residuals);
  Declaration& row(std::string name, Dimension dimension) {
    return column(std::move(name), dimension);
  }
  // More rows than the measurement has degrees of freedom: its noise is carried to them.
  Declaration& dependent_rows() { return dependent = true, *this; }

  const Input* find_input(std::string_view name) const;
  const Choice* find_choice(std::string_view name) const;
};

Declaration joint(std::string tag, std::string summary);
Declaration sensor(std::string tag, Dimension reading, Dimension value, std::string summary);
Declaration feature(std::string tag, Kind kind, std::string summary);
Declaration residual(std::string tag, std::vector<Kind> of, std::string summary);
Declaration shape(std::string tag, int freedom, int points, Sense sense, std::string summary);

// A registered plugin: its declaration and its functions, ready to be traced.
struct Plugin {
  using Inputs = std::span<const Expr>;
  using Choices = std::span<const int>;
  Declaration declaration;
  std::function<Rigid<Expr>(Inputs, Choices)> transform;    // joints; features' offset
  std::function<Expr(const Expr&, Inputs, Choices)> value;  // sensors
  std::function<Observed<Expr>(Inputs, Choices)> observe;   // features, from columns
  std::function<std::vector<Expr>(const Rigid<Expr>&, const Observed<Expr>&, Inputs, Choices)> rows;
  std::function<std::vector<Expr>(const Vector3<Expr>&, const Expr&)> deviations;  // shapes
  std::string origin;  // "built in", or the file it was loaded from
};

}  // namespace talus
