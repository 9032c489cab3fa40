#include "framework/registry/effect.h"

#include "framework/registry/plugin.h"

namespace talus {

std::string to_string(Acts acts) {
  static constexpr const char* names[] = {"reading", "coordinate", "axis", "about",   "link",
                                          "lengths", "fixture",    "tip",  "measured"};
  return names[static_cast<int>(acts)];
}

int parts_of(Acts acts) {
  switch (acts) {
    case Acts::reading:
    case Acts::coordinate:
    case Acts::lengths:
      return 1;
    case Acts::measured:
      return 9;
    default:
      return 6;
  }
}

std::string to_string(Covariate covariate) {
  static constexpr const char* names[] = {"approach", "time",   "session", "pose", "temperature",
                                          "rate",     "travel", "since",   "load", "tip_load"};
  return names[static_cast<int>(covariate)];
}

Declaration effect(std::string tag, Acts acts, std::string summary) {
  Declaration d{.family = Family::effect, .tag = std::move(tag), .summary = std::move(summary)};
  d.effect.acts = acts;
  return d;
}

Declaration& Declaration::amount(std::string name, Dimension dimension, double typical,
                                 std::string meaning) {
  Input i{std::move(name), dimension, 0, false, false, std::move(meaning), Role::amount, typical};
  inputs.push_back(std::move(i));
  return *this;
}

Declaration& Declaration::not_negative() {
  inputs.back().not_negative = true;
  return *this;
}

Declaration& Declaration::amount_of_reading(std::string name, Dimension dimension,
                                            double typical_angle, double typical_length,
                                            std::string meaning) {
  amount(std::move(name), dimension, typical_angle, std::move(meaning));
  inputs.back().typical_length = typical_length;
  inputs.back().relative = true;
  return *this;
}

Declaration& Declaration::setting(std::string name, Dimension dimension, double otherwise,
                                  std::vector<double> tries, std::string meaning) {
  Input i{std::move(name), dimension, otherwise, false, false, std::move(meaning), Role::setting};
  i.tries = std::move(tries);
  inputs.push_back(std::move(i));
  return *this;
}

Declaration& Declaration::setting_of_reading(std::string name, double otherwise,
                                             std::string meaning) {
  setting(std::move(name), number, otherwise, {}, std::move(meaning));
  inputs.back().relative = true;
  return *this;
}

Declaration& Declaration::of_sensor(std::string name, Dimension dimension) {
  Input i{name, dimension, 0, false, false, "input of the sensor", Role::borrowed};
  inputs.push_back(std::move(i));
  return *this;
}

Declaration& Declaration::needs(Covariate covariate) {
  effect.needs.push_back(covariate);
  return *this;
}

Declaration& Declaration::onset(std::string name, Covariate covariate, std::string meaning) {
  effect.onset = name;
  effect.onset_of = covariate;
  return needs(covariate).setting(std::move(name), number, 0, {}, std::move(meaning));
}

Declaration& Declaration::on(Dimension reading_dimension) {
  effect.on.push_back(reading_dimension);
  return *this;
}

Declaration& Declaration::driven_by(Driven driven, std::string meaning) {
  effect.driven = driven;
  effect.driver_meaning = std::move(meaning);
  return *this;
}

Declaration& Declaration::form(std::vector<std::string> amounts, Driven driven) {
  effect.forms.push_back({std::move(amounts), driven});
  return *this;
}

Declaration& Declaration::finer_form(std::vector<std::string> amounts) {
  form(std::move(amounts));
  effect.forms.back().finer = true;
  return *this;
}

Declaration& Declaration::shown(Figure figure) {
  effect.figures.push_back(std::move(figure));
  return *this;
}

Declaration& Declaration::same_as(std::string tag_of_other) {
  effect.same_as = std::move(tag_of_other);
  return *this;
}

Declaration& Declaration::reference(std::string text) {
  effect.reference = std::move(text);
  return *this;
}

Declaration& Declaration::at_joint() {
  effect.at_joint = true;
  return *this;
}

Declaration& Declaration::usual_size(double length_of_correction, double angle_of_correction) {
  effect.typical_length = length_of_correction;
  effect.typical_angle = angle_of_correction;
  return *this;
}

Declaration& Declaration::unknown() {
  effect.unknown = true;
  return *this;
}

Declaration& Declaration::everywhere() {
  effect.everywhere = true;
  return *this;
}

}  // namespace talus
