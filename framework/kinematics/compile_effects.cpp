// Effects: where they act, what is known there, and how their corrections enter the program.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "framework/kinematics/axis_place.h"
#include "framework/kinematics/compiler.h"
#include "framework/kinematics/covariates.h"
#include "framework/kinematics/effect_motion.h"

namespace talus {
namespace {

constexpr Dimension kForce = force, kTorque = torque;

// Does an expression's text speak of `name`?
bool mentions(const std::string& text, const std::string& name) {
  auto letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    if ((at == 0 || !letter(text[at - 1])) && (end == text.size() || !letter(text[end])))
      return true;
  }
  return false;
}

const Input* only_coordinate(const Declaration& d) {
  const Input* found = nullptr;
  for (const Input& i : d.inputs)
    if (i.coordinate) {
      if (found) return nullptr;
      found = &i;
    }
  return found;
}

}  // namespace

void Compiler::collect_effects() {
  for (const Element& e : model_.root.children)
    if (registry_.find(e.tag, Family::effect)) {
      for (const Element* other : effects_)
        if (owner(*other) == owner(e))
          throw InputError(e.place,
                           fmt::format("<{}> acts twice at '{}'", e.tag, e.text("at", "its place")),
                           "each effect once at a place, or a name=\"...\" of its own");
      effects_.push_back(&e);
    }
}

std::string Compiler::link_name(const Element& joint) const {
  if (const Attribute* a = joint.find("link")) return a->text;
  const std::string name = joint.name();
  return name.starts_with("joint") ? "link" + name.substr(5) : name;
}

std::string Compiler::joint_of(const std::string& sensor) const {
  for (const Element& chain : model_.root.children)
    for (const Element& joint : chain.children)
      if (const Plugin* plugin = registry_.find(joint.tag, Family::joint))
        for (const Input& i : plugin->declaration.inputs)
          if (i.coordinate && mentions(joint.text(i.name), sensor)) return joint.name();
  return "";
}

Expr Compiler::covariate(const std::string& column, Dimension dimension, const Place& place) {
  for (const Reading& r : program_.readings)
    if (r.covariate && r.column == column) return leaf(r.slot);
  Reading reading{column, column, dimension};
  reading.covariate = true;
  reading.place = place;
  reading.slot = new_slot(column);
  reading.value = leaf(reading.slot);
  program_.readings.push_back(reading);
  return reading.value;
}

// Is a covariate to be had at a place? Without fields the model says what it needs.
bool Compiler::known(Covariate c, const EffectPlace& place) const {
  if (!recorded_) return true;
  switch (c) {
    case Covariate::approach:
      return !place.joint.empty() && recorded_("approach_" + place.joint);
    case Covariate::rate:
      return place.acts == Acts::reading && recorded_("time") && recorded_(place.column);
    case Covariate::travel:
      return place.acts == Acts::reading && recorded_(place.column);
    case Covariate::since:
      return recorded_("time");
    case Covariate::load:
    case Covariate::tip_load:
      return !place.joint.empty() && recorded_("load:" + place.joint + ".mz");
    case Covariate::pose:
      return true;
    default:
      return recorded_(to_string(c));
  }
}

void Compiler::know(Covariate c, EffectPlace& place, const Place& where) {
  Around<Expr>& a = place.around;
  auto load = [&](const std::string& part, Dimension d) {
    return covariate("load:" + place.joint + "." + part, d, where);
  };
  auto vector = [&](const std::string& part, Dimension d) {
    return Vector3<Expr>{load(part + "x", d), load(part + "y", d), load(part + "z", d)};
  };
  switch (c) {
    case Covariate::approach:
      a.approach = covariate("approach_" + place.joint, number, where);
      break;
    case Covariate::time:
      a.time = covariate("time", duration, where);
      break;
    case Covariate::session:
      a.session = covariate("session", number, where);
      break;
    case Covariate::pose:
      a.pose = covariate("pose", number, where);
      break;
    case Covariate::temperature:
      a.temperature = covariate("temperature", temperature, where);
      break;
    case Covariate::rate:
      a.rate = covariate("rate:" + place.column, place.dimension / duration, where);
      break;
    case Covariate::travel:
      a.travel = covariate("travel:" + place.column, place.dimension, where);
      break;
    case Covariate::since:
      a.since = covariate("since", duration, where);
      break;
    case Covariate::load:
      a.force = vector("f", kForce), a.moment = vector("m", kTorque);
      break;
    case Covariate::tip_load:
      a.tip_force = vector("tip_f", kForce), a.tip_moment = vector("tip_m", kTorque);
      a.weight = vector("weight_", kForce), a.span = vector("span_", length);
      a.own_moment = vector("own_m", kTorque);
      break;
  }
  place.known.push_back(c);
}

Expr Compiler::driver(const Element& element) {
  const Attribute* a = element.find("driver");
  if (!a)
    throw InputError(element.place, fmt::format("<{}> has no driver", element.tag),
                     "driver=\"...\": the joint whose coordinate drives it");
  auto it = named_.find(a->text);
  if (it != named_.end())
    if (const Plugin* joint = registry_.find(it->second->tag, Family::joint))
      if (const Input* i = only_coordinate(joint->declaration)) return input(*it->second, *i).value;
  return resolve(a->text, a->place).value;
}

std::vector<Expr> Compiler::corrections(EffectPlace place, const std::vector<std::string>& names) {
  const int parts = parts_of(place.acts);
  std::vector<Expr> sum(parts, Expr(0));
  for (const std::string& name : names) places_.emplace(place.acts, name);
  for (const Element* e : effects_) {
    const Plugin& plugin = *registry_.find(e->tag, Family::effect);
    const Declaration& d = plugin.declaration;
    if (d.effect.acts != place.acts) continue;
    const std::string at = e->text("at", names.back());
    if (std::find(names.begin(), names.end(), at) == names.end()) continue;
    const Place where = e->find("at") ? e->find("at")->place : e->place;
    const auto& on = d.effect.on;
    if (!on.empty() && std::find(on.begin(), on.end(), place.dimension) == on.end()) {
      // All that is measured has one name; of it this acts on what it can.
      if (place.acts == Acts::measured && at == names.back()) continue;
      throw InputError(where,
                       fmt::format("<{}> does not act on '{}', which is {}", e->tag, at,
                                   describe(place.dimension)),
                       describe(on[0]));
    }
    placed_[e] = true;
    EffectPlace here = place;
    for (Covariate c : d.effect.needs) know(c, here, where);
    if (d.effect.driven != Driven::no) here.around.driver = driver(*e);
    std::vector<Expr> values;
    for (Input i : d.inputs) {
      if (i.role == Role::borrowed) {
        auto own = here.inputs.find(i.name);
        if (own == here.inputs.end())
          throw InputError(where,
                           fmt::format("<{}> needs a sensor with the input '{}'", e->tag, i.name));
        values.push_back(own->second);
        continue;
      }
      if (i.relative) i.dimension = i.dimension * place.dimension;
      values.push_back(input(*e, i).value);
    }
    const std::vector<Expr> more = plugin.act(here.around, values, choices(*e, d));
    if (std::all_of(more.begin(), more.end(), [](const Expr& u) { return u.is_constant(); }))
      null_effect_ = true;
    for (int k = 0; k < parts; ++k) sum[k] += more[k];
  }
  if (recorded_) {
    for (Covariate c : {Covariate::approach, Covariate::time, Covariate::session, Covariate::pose,
                        Covariate::temperature, Covariate::rate, Covariate::travel,
                        Covariate::since, Covariate::load, Covariate::tip_load})
      if (known(c, place)) know(c, place, model_.root.place);
    place.first_field = static_cast<int>(program_.parameters.size());
    for (int k = 0; k < parts; ++k) {
      const std::string name =
          fmt::format("field:{}:{}[{}]", to_string(place.acts), place.location, k);
      const Quantity free{.value = 0, .free = true};
      const Dimension dimension = place.acts == Acts::measured || place.acts == Acts::lengths
                                      ? number
                                  : parts == 1 ? place.dimension
                                  : k < 3      ? length
                                               : angle;
      const int slot = new_slot(name);
      program_.parameters.push_back({name, "", "", dimension, free, {}, slot});
      sum[k] += leaf(slot);
    }
    program_.places.push_back(std::move(place));
  }
  return sum;
}

Frame Compiler::joint_with_effects(const Element& joint, const Plugin& plugin) {
  const Declaration& d = plugin.declaration;
  std::vector<Expr> values = inputs(joint, d);
  std::vector<int> slots;  // of the coordinates
  EffectPlace place{Acts::coordinate, joint.name()};
  place.joint = joint.name();
  for (std::size_t i = 0; i < d.inputs.size(); ++i) {
    if (!d.inputs[i].coordinate) continue;
    const std::vector<int> on = support(values[i]);
    for (const Reading& r : program_.readings)
      if (!r.covariate && std::binary_search(on.begin(), on.end(), r.slot)) slots.push_back(r.slot);
    for (const Unknown& u : program_.unknowns)
      if (std::binary_search(on.begin(), on.end(), u.slot)) slots.push_back(u.slot);
  }
  const bool hangs = !slots.empty();
  if (const Input* only = only_coordinate(d); only && hangs) {
    const auto index = static_cast<std::size_t>(only - d.inputs.data());
    place.dimension = only->dimension;
    place.around.coordinate = values[index];
    values[index] += corrections(place, {joint.name()})[0];
  }
  Frame frame{joint.name(), -1, plugin.transform(values, choices(joint, d)), joint.place};
  auto at = axis_place(program_, frame.motion);
  if (at) frame.to_axis = at->before, frame.moving = at->moving;
  if (!hangs) return frame;
  auto of = [&](Acts acts, const std::string& location, const std::vector<std::string>& names) {
    EffectPlace p = place;
    p.acts = acts, p.location = location;
    return corrections(std::move(p), names);
  };
  const std::string link = link_name(joint);
  const auto axis = motion_of(of(Acts::axis, joint.name(), {joint.name()}));
  const auto about = motion_of(of(Acts::about, joint.name(), {joint.name()}));
  const auto tip = motion_of(of(Acts::link, link, {link, joint.name()}));
  const Expr stretch = Expr(1) + of(Acts::lengths, link, {link, "links"})[0];
  Rigid<Expr> ideal;
  for (Motion<Expr> m : frame.motion.motions()) {
    if (m.kind == Motion<Expr>::Kind::translation) m.amount = m.amount * stretch;
    for (Expr& t : m.translation) t = t * stretch;
    ideal = ideal * Rigid<Expr>(m);
  }
  frame.motion = ideal;
  at = axis_place(program_, ideal);
  if (at) frame.to_axis = at->before, frame.moving = at->moving;
  if (at && !(axis.motions().empty() && about.motions().empty()))
    frame.motion = at->before * axis * about * at->moving * inverse(about) * at->behind;
  frame.motion = frame.motion * tip;
  return frame;
}

// Directions are the cosines between the mapped vectors and the instrument's mapped axes where
// angles are measured, and the mapped vectors themselves where components are.
Rigid<Expr> Compiler::as_measured(int feature, const Matrix3<Expr>& R, const Vector3<Expr>& p) {
  const Feature& f = program_.features[feature];
  if (f.kind == Kind::nothing) return Rigid<Expr>(R, p);  // a closure: nothing is measured
  auto known = deformations_.find(feature);
  if (known == deformations_.end()) {
    EffectPlace place{Acts::measured, "measurement"};
    place.feature = feature;
    const bool direction = f.kind == Kind::direction;
    place.dimension = direction ? number : length;
    place.around.position = direction ? column(R, 2) : p;
    known = deformations_.emplace(feature, corrections(place, {f.name, "measurement"})).first;
  }
  Rigid<Expr> shown = mapped(f, R, p, known->second);
  if (std::any_of(known->second.begin(), known->second.end(),
                  [](const Expr& d) { return !(d.is_constant() && d.constant() == 0); }))
    program_.features[feature].shown = shown;
  return shown;
}

Rigid<Expr> Compiler::mapped(const Feature& f, const Matrix3<Expr>& R, const Vector3<Expr>& p,
                             const std::vector<Expr>& D) {
  const bool none = std::all_of(D.begin(), D.end(),
                                [](const Expr& e) { return e.is_constant() && e.constant() == 0; });
  if (none) return Rigid<Expr>(R, p);
  auto map = [&](const Vector3<Expr>& v) {
    Vector3<Expr> out = v;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out[i] += D[3 * i + j] * v[j];
    return out;
  };
  Matrix3<Expr> turned = R;
  if (f.kind == Kind::direction) {
    const Vector3<Expr> z = map(column(R, 2));
    const Expr size = norm(z);
    for (int i = 0; i < 3; ++i) {
      Vector3<Expr> e{Expr(0), Expr(0), Expr(0)};
      e[i] = Expr(1);
      const Vector3<Expr> axis = map(e);
      turned[i][2] = f.observed.angles ? dot(z, axis) / (size * norm(axis)) : z[i] / size;
    }
    // Errors of a direction are told along the axes across it, which turn with it.
    for (int c = 0; c < 2 && !f.observed.angles; ++c) {
      const Vector3<Expr> across = column(R, c), along = column(turned, 2);
      const Expr share = dot(across, along);
      for (int i = 0; i < 3; ++i) turned[i][c] = across[i] - share * along[i];
    }
  }
  return Rigid<Expr>(turned, map(p));
}

void Compiler::check_effects() const {
  for (const Element* e : effects_) {
    if (placed_.contains(e)) continue;
    const Declaration& d = registry_.find(e->tag, Family::effect)->declaration;
    std::vector<std::string> names;
    for (const auto& [acts, name] : places_)
      if (acts == d.effect.acts) names.push_back(name);
    const Attribute* at = e->find("at");
    throw InputError(at ? at->place : e->place,
                     at ? fmt::format("<{}> cannot act at '{}'", e->tag, at->text)
                        : fmt::format("<{}> does not say where it acts", e->tag),
                     names.empty() ? "a model with a place for it (it acts on a " +
                                         to_string(d.effect.acts) + ")"
                                   : "at=\"...\", one of: " + join(names),
                     at ? nearest(at->text, names) : "");
  }
}

// An effect that could follow several circumstances needs only those of the amounts that it has:
// play by the sense of approach needs no loads.
void Compiler::forget_unused_covariates() {
  std::set<int> used;
  for (const auto& slots : row_support(program_)) used.insert(slots.begin(), slots.end());
  auto use = [&](const Expr& e) {
    for (const int slot : support(e)) used.insert(slot);
  };
  for (const Frame& frame : program_.frames)
    for (const Motion<Expr>& m : frame.motion.motions()) {
      use(m.amount);
      for (int i = 0; i < 3; ++i) {
        use(m.translation[i]);
        for (int j = 0; j < 3; ++j) use(m.rotation[i][j]);
      }
    }
  if (null_effect_) return;  // which amounts it is to have is not known
  std::erase_if(program_.readings, [&](const Reading& r) {
    return r.covariate && is_derived(r.column) && !used.contains(r.slot);
  });
}

}  // namespace talus
