// A compiled model: immutable, and safe to share between threads.
//
// Compiling runs every plugin once on tracing numbers. What is left is one tape of scalar
// expressions on numbered slots (free parameters, readings, unknowns, measured columns,
// covariates), chains of elementary motions whose amounts are such expressions, and residual rows
// as expressions of the chains' end poses and of the measured columns. The solver never learns
// which joint it was.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/kinematics/limb.h"
#include "framework/kinematics/rigid.h"
#include "framework/model/model.h"
#include "framework/model/quantity.h"
#include "framework/registry/registry.h"

namespace talus {

// A free number of the model.
struct Parameter {
  std::string name;                // "joint2.a", or the name of a <parameter>
  std::string element, attribute;  // where its text stands in the model
  Dimension dimension;
  Quantity nominal;
  Place place;
  int slot = -1;
};

// A sensor's raw reading.
struct Reading {
  std::string sensor, column;
  Dimension dimension;
  double sigma = 0;                                // standard deviation of its noise
  std::optional<std::pair<double, double>> range;  // of the reading
  Place place;
  int slot = -1;
  Expr value;              // the coordinate it means, calibrated
  bool covariate = false;  // a circumstance that effects depend on, not a coordinate
};

// A number found per pose (`per` empty) or per group of rows with equal values in the columns
// `per`.
struct Unknown {
  std::string name;
  Dimension dimension;
  Quantity start;
  std::vector<std::string> per;
  Place place;
  int slot = -1;
};

// A measured column.
struct MeasuredColumn {
  std::string name;
  Dimension dimension;
  Place place;
  int slot = -1;
};

// A place at which effects can act, with all that is known there; and, where fields were asked for,
// the parameters that stand for a constant correction there.
struct EffectPlace {
  Acts acts = Acts::reading;
  std::string location;
  Dimension dimension;                 // of the reading or coordinate
  Around<Expr> around;                 // what is not known is 0
  std::vector<Covariate> known;        // what is
  std::map<std::string, Expr> inputs;  // of the sensor
  std::string column;                  // of the reading
  std::string joint;                   // whose coordinate it is, or whose axis or link
  int feature = -1;
  int first_field = -1;  // index among the parameters; parts_of(acts) of them
};

// A frame of the tree; `motion` is T_parent_frame, with all effects. Of the joint as it would be
// without: T_parent_S of its axis frame S, and what a coordinate moves there (axis_place.h); both
// empty where nothing moves it.
struct Frame {
  std::string name;
  int parent = -1;  // -1: the root
  Rigid<Expr> motion;
  Place place;
  Rigid<Expr> to_axis = {}, moving = {};
};

// The mass of the rigid body that a frame belongs to, from that frame's joint to the next.
struct Link {
  int frame = -1;
  double mass = 0;
  Vector3<double> com{};  // centre of mass in the frame
  Place place;
};

struct Gravity {
  int frame = 0;                // in which the direction is given
  Vector3<double> direction{};  // unit vector, downwards
  double magnitude = 0;         // mm/s^2
  int held_at = -1;             // frame that something holds, so that no joint carries a torque
  Place place;
};

// A point mass at a frame's origin: of the recordings' column, or always the same.
struct Payload {
  int frame = -1;
  std::string column;  // empty: `mass` holds
  double mass = 0;
  Place place;
};

// T_in_at as a product of motions; its end pose is read through twelve slots, the rotation's
// rows then the translation.
struct Chain {
  std::string in, at;
  Rigid<Expr> motions;
  int first_slot = -1;
  std::array<std::string, 2> key() const { return {in, at}; }
};

// A shape probed by a coordinate measuring machine, and how its points make it (see
// framework/metrology).
struct ProbedShape {
  std::string name, tag;
  Declaration declaration;
  std::function<std::vector<Expr>(const Vector3<Expr>&, const Expr&)> deviations;
  int on = -1;                          // shape onto whose plane the points are projected first
  std::vector<int> through;             // shapes whose origins are its points; else probed points
  std::optional<double> radius, sigma;  // known radius; standard deviation of a probed point
  int frame = -1;                       // on which frame of the model it lies, for simulation
  std::vector<Vector3<double>> probe;   // where it is probed, in that frame
  Place place;
};

// A frame made of shapes: the first axis is a shape's own, the second as near as it can be at right
// angles to it; the origin is nearest to all the shapes named for it. A third is for checking only.
struct Datum {
  struct Axis {
    int axis = 0;  // 0, 1, 2: x, y, z of the datum
    bool reversed = false;
    int shape = -1;
  };
  std::string name;
  std::vector<int> origin;
  std::vector<Axis> axes;        // primary, secondary, perhaps the one to check
  std::optional<double> square;  // rad: how far from square the shapes' axes may be
  Place place;
};

// By what a feature is probed: a datum, or a shape; in a datum, or in the machine's own axes.
struct Probed {
  int datum = -1, shape = -1, in = -1;
  explicit operator bool() const { return datum >= 0 || shape >= 0; }
};

struct Feature {
  std::string name, tag;
  Kind kind = Kind::nothing;
  int chain = -1;
  std::vector<int> columns;  // indices of measured columns
  std::optional<double> sigma_length, sigma_angle, sigma_number;
  Observed<Expr> observed;
  std::optional<Rigid<Expr>> shown;  // the chain's end pose as a faulty machine shows it
  Probed probed;
  bool carried = false;  // rows follow from one another: their noise is that of the columns
  Place place;
};

// One residual row: measured minus modelled, in internal units.
struct Row {
  std::string measure;  // "E.x", "P", "IDCx"
  Dimension dimension;
  Expr value;
  int feature = -1;
  int term = -1;                // which residual of <calibrate>
  std::optional<double> sigma;  // stated standard deviation of the measurement
  double weight = 1;            // of its term
};

enum class Objective { least_squares, as_published };
enum class LossKind { none, huber, cauchy };

struct CalibrationSettings {
  Objective objective = Objective::least_squares;
  LossKind loss = LossKind::none;
  double loss_scale = 2;    // in sigmas
  bool weighted = false;    // weights were given: rows are weighted by them rather than by sigmas
  bool full_scale = false;  // rows are divided by their full-scale range first
  std::vector<std::string> groups;  // columns whose equal rows are held out together
};

struct Program {
  std::string name;
  UnitSystem units;
  std::unique_ptr<Tape> tape = std::make_unique<Tape>();
  int slots = 0;
  std::vector<std::string> slot_names;
  std::vector<Parameter> parameters;
  std::vector<Reading> readings;
  std::vector<Unknown> unknowns;
  std::vector<MeasuredColumn> columns;
  std::vector<Frame> frames;
  std::map<std::string, int> frame_index;  // aliases included
  std::vector<Limb> limbs;
  std::vector<Link> links;
  std::optional<Gravity> gravity;
  std::vector<Payload> payloads;
  std::vector<Chain> chains;
  std::vector<ProbedShape> shapes;
  std::vector<Datum> datums;
  std::vector<Feature> features;
  std::vector<Row> rows;
  std::vector<EffectPlace> places;
  std::vector<std::string> terms;  // residual names, in order
  CalibrationSettings settings;

  int frame(const std::string& name, const Place& place) const;  // InputError where unknown
  Rigid<Expr> between(int in, int at) const;                     // T_in_at through the tree
};

// The slots (data, parameters, unknowns) that each residual row depends on, through its chain too.
std::vector<std::vector<int>> row_support(const Program& program);

// Compiles a checked model. InputError for: wrong or missing units, unknown or cyclic names, frames
// that hang loose or are reached twice, residuals that do not fit their feature, a free parameter
// that no residual sees.
Program compile(const Model& model, const Registry& registry);

// The same with fields: a constant correction at every place where effects can act, as further free
// parameters with null value 0 and no tolerance. `recorded` says which columns there are, which
// decides what is known at the places.
using Recorded = std::function<bool(const std::string& column)>;
Program compile_with_fields(const Model& model, const Registry& registry, const Recorded& recorded);

}  // namespace talus
