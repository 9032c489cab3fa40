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
//     effect   T | Twist<T> | Matrix3<T> act(const Around<T>& around, T inputs...)   see effect.h
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "framework/kinematics/rigid.h"
#include "framework/model/units.h"
#include "framework/registry/effect.h"

namespace talus {

enum class Family { joint, sensor, feature, residual, shape, effect };
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
  // Of effects:
  Role role = Role::plain;
  double typical = 0;         // amounts: usual size, the prior's standard deviation
  double typical_length = 0;  // the same where the reading that it is relative to is a length
  bool relative = false;      // its dimension is to be multiplied by that of the reading
  bool not_negative = false;  // amounts: what gives way under a load does so in its direction
  std::vector<double> tries;  // settings: values that a diagnosis tries
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
  EffectTraits effect;  // effects only

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

  // Of effects (effect.h). An amount is zero where nothing is wrong; `typical` is its usual size.
  Declaration& amount(std::string name, Dimension dimension, double typical, std::string meaning);
  // In units of the reading it corrects, times `dimension`: usual size of an angle, of a length.
  Declaration& not_negative();  // of the amount before
  Declaration& amount_of_reading(std::string name, Dimension dimension, double typical_angle,
                                 double typical_length, std::string meaning);
  Declaration& setting(std::string name, Dimension dimension, double otherwise,
                       std::vector<double> tries, std::string meaning);
  // In units of the reading, as amounts of it are.
  Declaration& setting_of_reading(std::string name, double otherwise, std::string meaning);
  // The input of the same name of the sensor that is corrected.
  Declaration& of_sensor(std::string name, Dimension dimension);
  Declaration& needs(Covariate covariate);
  // From which value of a covariate on it acts; a setting of that name.
  Declaration& onset(std::string name, Covariate covariate, std::string meaning);
  Declaration& on(Dimension reading);  // corrects only readings and coordinates of this dimension
  Declaration& driven_by(Driven driven, std::string meaning);  // an attribute `driver`
  // A subset of the amounts, tried by itself.
  Declaration& form(std::vector<std::string> amounts, Driven driven = Driven::no);
  Declaration& finer_form(std::vector<std::string> amounts);
  Declaration& at_joint();  // is called by the joint where the reading is an angle
  Declaration& usual_size(double length_of_correction, double angle_of_correction);
  Declaration& shown(Figure figure);
  Declaration& same_as(std::string tag);  // the same formula: not tried again by a diagnosis
  Declaration& reference(std::string text);
  Declaration&
  unknown();  // a curve of no known cause: what a diagnosis finds when nothing else fits
  Declaration& everywhere();  // one effect for all places of its kind

  const Input* find_input(std::string_view name) const;
  const Choice* find_choice(std::string_view name) const;
};

Declaration joint(std::string tag, std::string summary);
Declaration sensor(std::string tag, Dimension reading, Dimension value, std::string summary);
Declaration feature(std::string tag, Kind kind, std::string summary);
Declaration residual(std::string tag, std::vector<Kind> of, std::string summary);
Declaration shape(std::string tag, int freedom, int points, Sense sense, std::string summary);
Declaration effect(std::string tag, Acts acts, std::string summary);

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
  // effects: 1, 6 or 9 numbers (see parts_of)
  std::function<std::vector<Expr>(const Around<Expr>&, Inputs, Choices)> act;
  std::string origin;  // "built in", or the file it was loaded from
};

}  // namespace talus
