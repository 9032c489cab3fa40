#include "framework/diagnosis/covariate_axes.h"

#include <algorithm>

#include "framework/kinematics/tape_values.h"

namespace talus {
namespace {

const Unit kPlain{"1", number, 1, 0};

}  // namespace

std::vector<CovariateAxis> covariate_axes(const Accepted& e, const EffectPlace& place,
                                          const Program& program, const UnitSystem& units) {
  const EffectTraits& effect = e.suspect.plugin->declaration.effect;
  const auto& a = place.around;
  std::vector<CovariateAxis> axes;
  auto add = [&](std::string name, const Unit& unit, const Expr& value) {
    if (!value.is_constant())
      axes.push_back({std::move(name), unit.text, unit.factor, value, unit.dimension});
  };
  auto add_vector = [&](const std::string& name, const Vector3<Expr>& v, const Unit& unit) {
    for (int i = 0; i < 3; ++i) add(name + " along " + "xyz"[i], unit, v[static_cast<size_t>(i)]);
  };
  const Unit seconds{"s", duration, 1, 0}, newtons{"N", number, 1000, 0},
      torques{"N*mm", number, 1000, 0}, own = units.of(place.dimension);
  if (!effect.onset.empty()) {
    const bool session = effect.onset_of == Covariate::session;
    add(session ? "session" : "pose", kPlain, session ? a.session : a.pose);
    return axes;
  }
  if (!e.way.driver.empty())
    for (const EffectPlace& other : program.places)
      if (other.acts == Acts::coordinate && other.joint == e.way.driver) {
        add(e.way.driver, units.of(other.dimension), other.around.coordinate);
        return axes;
      }
  for (const Covariate c : effect.needs) {
    if (std::find(place.known.begin(), place.known.end(), c) == place.known.end()) continue;
    switch (c) {
      case Covariate::approach:
        add("approach", kPlain, a.approach);
        break;
      case Covariate::time:
        add("time", seconds, a.time);
        break;
      case Covariate::session:
        add("session", kPlain, a.session);
        break;
      case Covariate::pose:
        add("pose", kPlain, a.pose);
        break;
      case Covariate::temperature:
        add("temperature", {"degC", temperature, 1, 0}, a.temperature);
        break;
      case Covariate::rate:
        add("rate", {own.text + "/s", number, own.factor, 0}, a.rate);
        break;
      case Covariate::travel:
        add("travel since reversal", own, a.travel);
        break;
      case Covariate::since:
        add("time in session", seconds, a.since);
        break;
      case Covariate::load:
        add_vector("moment", a.moment, torques), add_vector("force", a.force, newtons);
        break;
      case Covariate::tip_load:
        add_vector("moment on the end", a.tip_moment, torques);
        add_vector("force on the end", a.tip_force, newtons);
        break;
    }
  }
  if (!axes.empty()) return axes;
  if (place.acts == Acts::reading)
    add(place.location, own, a.reading);
  else if (place.acts == Acts::measured)
    add_vector("position", a.position, units.length);
  else
    add(place.joint.empty() ? place.location : place.joint,
        place.dimension == length ? units.length : units.angle, a.coordinate);
  return axes;
}

Eigen::VectorXd values_at(const Linearised& at, const Expr& e) {
  TapeValues tape(*at.program->tape, {e.node()});
  Eigen::VectorXd v(static_cast<Eigen::Index>(at.slots.size()));
  for (std::size_t k = 0; k < at.slots.size(); ++k)
    v[static_cast<Eigen::Index>(k)] = tape(at.slots[k])[0];
  return v;
}

const Suspect* suspect_of(const Linearised& at, const Accepted& e) {
  for (const Suspect& s : at.suspects.suspects)
    if (s.plugin == e.suspect.plugin && s.at == e.suspect.at) return &s;
  return nullptr;
}

}  // namespace talus
