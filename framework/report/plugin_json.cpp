#include "framework/report/plugin_json.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

std::string role_name(Role role) {
  switch (role) {
    case Role::amount:
      return "amount";
    case Role::setting:
      return "setting";
    case Role::borrowed:
      return "borrowed";
    case Role::plain:
      break;
  }
  return "plain";
}

std::string driven_name(Driven driven) {
  switch (driven) {
    case Driven::by_other:
      return "other";
    case Driven::by_own:
      return "own";
    case Driven::by_any:
      return "any";
    case Driven::no:
      break;
  }
  return "no";
}

// What is relative to a reading is told for a reading that is an angle, and `length` for one that
// is a length.
Json sizes(const Input& i, Dimension reading, double typical, const UnitSystem& units) {
  const Unit unit = units.of(i.relative ? i.dimension * reading : i.dimension);
  Json tries = Json::array();
  for (double v : i.tries) tries.push_back(v / unit.factor);
  Json j{{"unit", unit.text}, {"otherwise", i.otherwise / unit.factor}};
  if (i.role == Role::amount) j["typical"] = typical / unit.factor;
  if (i.role == Role::setting) j["tries"] = tries;
  return j;
}

Json json_of(const Input& i, const UnitSystem& units) {
  Json j{{"name", i.name}, {"role", role_name(i.role)}, {"meaning", i.meaning}};
  if (i.coordinate) j["coordinate"] = true;
  if (i.required) j["required"] = true;
  if (i.not_negative) j["not_negative"] = true;
  j.update(sizes(i, angle, i.typical, units));
  if (i.relative) j["length"] = sizes(i, length, i.typical_length, units);
  return j;
}

Json json_of(const Declaration& d, const EffectTraits& e, const UnitSystem& units) {
  Json j{{"acts", to_string(e.acts)}, {"driven", driven_name(e.driven)}};
  j["needs"] = Json::array();
  for (Covariate c : e.needs) j["needs"].push_back(to_string(c));
  j["on"] = Json::array();
  for (Dimension on : e.on) j["on"].push_back(units.of(on).text);
  j["everywhere"] = e.everywhere, j["unknown"] = e.unknown, j["at_joint"] = e.at_joint;
  j["same_as"] = e.same_as.empty() ? Json() : Json(e.same_as);
  j["onset"] = e.onset.empty() ? Json() : Json(e.onset);
  if (e.typical_length > 0) j["typical_length"] = e.typical_length;
  if (e.typical_angle > 0) j["typical_angle"] = e.typical_angle / units.of(angle).factor;
  j["forms"] = Json::array();
  for (const EffectForm& form : e.forms)
    j["forms"].push_back(
        {{"amounts", form.amounts},
         {"driven", driven_name(form.driven == Driven::no ? e.driven : form.driven)}});
  if (!e.forms.empty()) return j;
  std::vector<std::string> all;
  for (const Input& i : d.inputs)
    if (i.role == Role::amount) all.push_back(i.name);
  j["forms"].push_back({{"amounts", all}, {"driven", driven_name(e.driven)}});
  return j;
}

}  // namespace

Json json_of(const Plugin& plugin) {
  const UnitSystem units;
  const Declaration& d = plugin.declaration;
  Json j{{"name", d.tag},
         {"family", to_string(d.family)},
         {"summary", d.summary},
         {"origin", plugin.origin}};
  j["inputs"] = Json::array();
  for (const Input& i : d.inputs) j["inputs"].push_back(json_of(i, units));
  j["choices"] = Json::array();
  for (const Choice& c : d.choices)
    j["choices"].push_back({{"name", c.name}, {"words", c.words}, {"meaning", c.meaning}});
  if (d.family == Family::sensor)
    j["reading"] = units.of(d.reading).text, j["value"] = units.of(d.value).text;
  if (d.family == Family::effect) j.update(json_of(d, d.effect, units));
  return j;
}

}  // namespace talus
