#include "framework/registry/registry.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "framework/registry/bind.h"

namespace talus {

std::string to_string(Family family) {
  static constexpr const char* names[] = {"joint",    "sensor", "feature",
                                          "residual", "shape",  "effect"};
  return names[static_cast<int>(family)];
}

std::string to_string(Kind kind) {
  static constexpr const char* names[] = {"frame", "point", "direction", "scalar", "closure"};
  return names[static_cast<int>(kind)];
}

Declaration& Declaration::coordinate(std::string name, Dimension dimension, std::string meaning) {
  inputs.push_back({std::move(name), dimension, 0, true, true, std::move(meaning)});
  return *this;
}

Declaration& Declaration::input(std::string name, Dimension dimension, double otherwise,
                                std::string meaning) {
  inputs.push_back({std::move(name), dimension, otherwise, false, false, std::move(meaning)});
  return *this;
}

Declaration& Declaration::required(std::string name, Dimension dimension, std::string meaning) {
  inputs.push_back({std::move(name), dimension, 0, false, true, std::move(meaning)});
  return *this;
}

Declaration& Declaration::choice(std::string name, std::vector<std::string> words,
                                 std::string meaning) {
  choices.push_back({std::move(name), std::move(words), std::move(meaning)});
  return *this;
}

Declaration& Declaration::column(std::string suffix, Dimension dimension) {
  columns.push_back({std::move(suffix), dimension});
  return *this;
}

Declaration& Declaration::judged_by(std::vector<std::string> tags) {
  residuals = std::move(tags);
  return *this;
}

const Input* Declaration::find_input(std::string_view name) const {
  auto it =
      std::find_if(inputs.begin(), inputs.end(), [&](const Input& i) { return i.name == name; });
  return it == inputs.end() ? nullptr : &*it;
}

const Choice* Declaration::find_choice(std::string_view name) const {
  auto it =
      std::find_if(choices.begin(), choices.end(), [&](const Choice& c) { return c.name == name; });
  return it == choices.end() ? nullptr : &*it;
}

Declaration joint(std::string tag, std::string summary) {
  return {.family = Family::joint, .tag = std::move(tag), .summary = std::move(summary)};
}

Declaration sensor(std::string tag, Dimension reading, Dimension value, std::string summary) {
  Declaration d{.family = Family::sensor, .tag = std::move(tag), .summary = std::move(summary)};
  d.reading = reading;
  d.value = value;
  return d;
}

Declaration feature(std::string tag, Kind kind, std::string summary) {
  Declaration d{.family = Family::feature, .tag = std::move(tag), .summary = std::move(summary)};
  d.kinds = {kind};
  return d;
}

Declaration residual(std::string tag, std::vector<Kind> of, std::string summary) {
  Declaration d{.family = Family::residual, .tag = std::move(tag), .summary = std::move(summary)};
  d.kinds = std::move(of);
  return d;
}

Declaration shape(std::string tag, int freedom, int points, Sense sense, std::string summary) {
  Declaration d{.family = Family::shape, .tag = std::move(tag), .summary = std::move(summary)};
  d.freedom = freedom;
  d.points = points;
  d.sense = sense;
  return d;
}

namespace bind {

// Plugins made before main; taken over when the registry is first asked for.
static Makers& built_in_makers() {
  static Makers makers;
  return makers;
}

bool add_built_in(Plugin (*maker)()) {
  built_in_makers().push_back(maker);
  return true;
}

void check_arity(const Declaration& d, const char* function, int inputs, int choices, int wanted) {
  if (inputs != wanted || choices != int(d.choices.size()))
    throw InputError(fmt::format(
        "plugin '{}': {}() takes {} numbers and {} choices, its declaration has {} and {}", d.tag,
        function, inputs, choices, wanted, d.choices.size()));
}

}  // namespace bind

Registry& Registry::built_in() {
  static Registry registry = [] {
    Registry r;
    for (auto maker : bind::built_in_makers()) {
      Plugin plugin = maker();
      plugin.origin = "built in";
      r.add(std::move(plugin));
    }
    return r;
  }();
  return registry;
}

static bool is_identifier(std::string_view s) {
  return !s.empty() && !std::isdigit(static_cast<unsigned char>(s[0])) &&
         std::all_of(s.begin(), s.end(),
                     [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

static const Plugin* look_up(const std::map<std::string, Plugin, std::less<>>& plugins,
                             std::string_view tag) {
  auto it = plugins.find(tag);
  return it == plugins.end() ? nullptr : &it->second;
}

void Registry::add(Plugin plugin) {
  const Declaration& d = plugin.declaration;
  auto refuse = [&](const std::string& why) {
    throw InputError({plugin.origin, 0, 0}, fmt::format("plugin '{}': {}", d.tag, why));
  };
  if (!is_identifier(d.tag)) refuse("its tag is not a word of letters, digits and '_'");
  auto& plugins = d.family == Family::residual ? residuals_ : elements_;
  if (const Plugin* other = look_up(plugins, d.tag))
    refuse(fmt::format("its tag is taken by a {} ({})", to_string(other->declaration.family),
                       other->origin));
  if (d.summary.empty()) refuse("it has no summary");
  std::vector<std::string> seen{"name"};
  auto once = [&](const std::string& name, const std::string& meaning) {
    if (!is_identifier(name))
      refuse("input '" + name + "' is not a word of letters, digits and '_'");
    if (std::find(seen.begin(), seen.end(), name) != seen.end())
      refuse("'" + name + "' is declared twice");
    if (meaning.empty()) refuse("input '" + name + "' has no meaning");
    seen.push_back(name);
  };
  for (const Input& input : d.inputs) once(input.name, input.meaning);
  for (const Choice& choice : d.choices) once(choice.name, choice.meaning);
  const bool whole = d.family == Family::joint    ? bool(plugin.transform)
                     : d.family == Family::sensor ? bool(plugin.value)
                     : d.family == Family::feature
                         ? d.kinds.size() == 1 && (plugin.observe || d.kinds[0] == Kind::nothing)
                     : d.family == Family::residual ? plugin.rows && !d.columns.empty()
                     : d.family == Family::shape    ? plugin.deviations && d.freedom > 0
                                                    : bool(plugin.act);
  if (!whole) refuse("it lacks the function that a " + to_string(d.family) + " must have");
  plugins.emplace(std::string(d.tag), std::move(plugin));
}

const Plugin* Registry::find(std::string_view tag) const {
  const Plugin* plugin = look_up(elements_, tag);
  return plugin ? plugin : look_up(residuals_, tag);
}

const Plugin* Registry::find(std::string_view tag, Family family) const {
  const Plugin* plugin = look_up(family == Family::residual ? residuals_ : elements_, tag);
  return plugin && plugin->declaration.family == family ? plugin : nullptr;
}

std::vector<const Plugin*> Registry::all() const {
  std::vector<const Plugin*> result;
  for (const auto* plugins : {&elements_, &residuals_})
    for (const auto& [tag, plugin] : *plugins) result.push_back(&plugin);
  std::stable_sort(result.begin(), result.end(), [](const Plugin* a, const Plugin* b) {
    return a->declaration.family < b->declaration.family;
  });
  return result;
}

std::vector<std::string> Registry::tags(Family family) const {
  std::vector<std::string> result;
  for (const auto& [tag, plugin] : family == Family::residual ? residuals_ : elements_)
    if (plugin.declaration.family == family) result.push_back(tag);
  return result;
}

void Registry::load_library(const std::string& file) {
  const Place place{file, 0, 0};
  const std::string path = std::filesystem::absolute(file).string();
  if (!std::filesystem::exists(path)) throw InputError(place, "no such plugin file");
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw InputError(place, "cannot be loaded as a plugin library", dlerror());
  auto version = reinterpret_cast<int (*)()>(dlsym(library, "talus_plugin_interface"));
  auto hand_over =
      reinterpret_cast<void (*)(Registry*, const char*)>(dlsym(library, "talus_plugin_register"));
  if (!version || !hand_over)
    throw InputError(place, "is a shared library, but not a Talus plugin",
                     "it to be built with talus_add_plugin() and to contain TALUS_PLUGIN(...)");
  if (version() != plugin_interface_version)
    throw InputError(place,
                     fmt::format("was built for plugin interface {}, this is interface {}",
                                 version(), plugin_interface_version),
                     "it to be rebuilt against this version");
  hand_over(this, file.c_str());
}

}  // namespace talus
