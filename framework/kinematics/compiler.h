// The compiler's inside: works out names, then frames, then residual rows, into one Program.
#pragma once

#include <set>

#include "framework/kinematics/expression.h"
#include "framework/kinematics/program.h"

namespace talus {

// The words of a comma-separated list, each with its place.
std::vector<Attribute> split_list(const Attribute& attribute);

class Compiler {
 public:
  Compiler(const Model& model, const Registry& registry);
  Program run();
  // Adds a field at every place; what is recorded decides what is known there.
  void with_fields(const Recorded& recorded) { recorded_ = recorded; }

 private:
  // names (compile_names.cpp)
  void collect(const Element& element);
  Term resolve(const std::string& name, const Place& place);
  std::string owner(const Element& element) const;  // what its inputs' names begin with
  Term input(const Element& element, const Input& input);
  std::vector<Expr> inputs(const Element& element, const Declaration& declaration);
  std::vector<int> choices(const Element& element, const Declaration& declaration);
  Term quantity_or_expression(const std::string& name, const std::string& owner,
                              const Attribute& attribute, Dimension dimension);
  Expr free_parameter(const std::string& name, const std::string& owner, const Attribute& attribute,
                      Dimension dimension, const Quantity& quantity);
  Dimension kind(const Element& element) const;
  int new_slot(const std::string& name);
  Expr leaf(int slot) { return Expr::leaf(*program_.tape, slot); }
  void sensor(const Element& element);
  void unknown(const Element& element);

  // frames (compile_frames.cpp)
  void frames();

  // effects (compile_effects.cpp)
  void collect_effects();
  std::string link_name(const Element& joint) const;
  std::string joint_of(const std::string& sensor) const;
  Expr covariate(const std::string& column, Dimension dimension, const Place& place);
  bool known(Covariate covariate, const EffectPlace& place) const;
  void know(Covariate covariate, EffectPlace& place, const Place& where);
  // The sum of the effects at a place that answers to any of the names, as parts_of(acts) numbers.
  std::vector<Expr> corrections(EffectPlace place, const std::vector<std::string>& names);
  Expr driver(const Element& element);
  // The frame behind a joint, its parent not yet known.
  Frame joint_with_effects(const Element& joint, const Plugin& plugin);
  void check_effects() const;
  void forget_unused_covariates();
  // What the instrument shows of a feature whose modelled pose is (R, p).
  Rigid<Expr> mapped(const Feature& feature, const Matrix3<Expr>& R, const Vector3<Expr>& p,
                     const std::vector<Expr>& D);
  Rigid<Expr> as_measured(int feature, const Matrix3<Expr>& R, const Vector3<Expr>& p);

  // shapes, datums and what is probed by them (compile_probing.cpp)
  void shape(const Element& element);
  void datum(const Element& element);
  Probed probed(const Element& element, Kind kind) const;
  int find_shape(const Attribute& word) const;

  // limbs (compile_limbs.cpp)
  void limb(const Element& element);
  double fixed(const Attribute& attribute, Dimension dimension, const std::string& expected);

  // masses, gravity, payloads (compile_loads.cpp)
  void link(const Element& joint);
  void gravity(const Element& element);
  void payload(const Element& element);
  double fixed_mass(const Attribute& attribute);

  // features and residual rows (compile_rows.cpp)
  void feature(const Element& element);
  void calibrate(const Element& element);
  void default_rows();
  void add_rows(const std::string& residual, int feature, const std::vector<Expr>& inputs,
                double weight, int term);
  void check_seen() const;
  void check_sigmas() const;

  const Model& model_;
  const Registry& registry_;
  bool null_effect_ = false;  // one whose amounts are all zero
  Program program_;
  std::map<std::string, const Element*> named_;  // every element with a name
  std::map<std::string, Term> known_;            // names worked out so far
  std::set<std::string> in_progress_;
  Recorded recorded_;  // fields are wanted where this is set
  std::vector<const Element*> effects_;
  mutable std::map<const Element*, bool> placed_;  // effects that found their place
  std::map<int, std::vector<Expr>> deformations_;  // what is measured of each feature
  std::set<std::pair<Acts, std::string>> places_;  // names of places, for messages
  std::set<std::pair<std::string, int>> taken_;    // residuals and the features they were taken of
};

}  // namespace talus
