#include <fmt/format.h>

#include <memory>

#include "framework/cli/commands.h"
#include "framework/cli/terminal.h"
#include "framework/report/layout.h"
#include "framework/report/plugin_json.h"

namespace talus {
namespace {

// Units of what is relative to a reading are its own.
std::string unit_text(const Input& input, const UnitSystem& units) {
  const std::string text = units.of(input.dimension).text;
  return input.relative ? "reading" + text.substr(text.starts_with("1")) : text;
}

std::string acts_text(const EffectTraits& effect) {
  std::string out = fmt::format("  acts: {}", to_string(effect.acts));
  std::vector<std::string> needs;
  for (Covariate c : effect.needs) needs.push_back(to_string(c));
  if (!needs.empty()) out += fmt::format("; needs {}", join(needs));
  if (effect.driven != Driven::no) out += "; driver: " + effect.driver_meaning;
  if (!effect.reference.empty()) out += "; " + effect.reference;
  return out + "\n";
}

std::string describe_plugin(const Plugin& plugin) {
  const Declaration& d = plugin.declaration;
  const UnitSystem units;
  std::string out =
      fmt::format("{} ({}, {})\n  {}\n", d.tag, to_string(d.family), plugin.origin, d.summary);
  if (d.family == Family::sensor)
    out += fmt::format("  reading in {}, value in {}\n", units.of(d.reading).text,
                       units.of(d.value).text);
  Table inputs({"<input", "<unit", "<default", "<meaning"});
  for (const Input& i : d.inputs) {
    if (i.role == Role::borrowed) continue;
    if (d.effect.unknown && i.role == Role::amount && &i != &d.inputs[0] &&
        (&i + 1)->role == Role::amount)
      continue;  // of a curve's many heights, the first and the last
    const std::string otherwise =
        i.coordinate ? "coordinate"
        : i.required ? "required"
                     : fmt::format("{:.12g}", i.otherwise / units.of(i.dimension).factor);
    std::string meaning = i.meaning;
    if (i.role == Role::amount && !i.relative)
      meaning += fmt::format("; usual size {:.3g}", i.typical / units.of(i.dimension).factor);
    inputs.row({i.name, unit_text(i, units), otherwise, meaning});
  }
  for (const Choice& c : d.choices) inputs.row({c.name, "", join(c.words, "|"), c.meaning});
  if (!inputs.empty()) out += inputs.text();
  if (!d.columns.empty()) {
    std::string list;
    for (const Column& c : d.columns)
      list += fmt::format(" {}[{}]", c.suffix.empty() ? "(name)" : c.suffix,
                          units.of(c.dimension).text);
    out += fmt::format("  {}:{}\n", d.family == Family::residual ? "rows" : "columns", list);
  }
  if (!d.residuals.empty())
    out += "  residuals, where the model names none: " + join(d.residuals) + "\n";
  if (d.family == Family::effect) out += acts_text(d.effect);
  if (d.family == Family::residual) {
    std::vector<std::string> kinds;
    for (Kind k : d.kinds) kinds.push_back(to_string(k));
    out += "  of: " + join(kinds) + "\n";
  }
  return out;
}

void write_json(const std::vector<const Plugin*>& plugins, const std::string& file) {
  auto list = nlohmann::ordered_json::array();
  for (const Plugin* plugin : plugins) list.push_back(json_of(*plugin));
  put(file, nlohmann::ordered_json{{"talus", TALUS_VERSION}, {"plugins", list}}.dump(2) + "\n");
}

void run(const std::string& name, const Common& common) {
  const Registry registry = common.registry();
  std::vector<const Plugin*> all = registry.all();
  if (!name.empty()) std::erase_if(all, [&](auto* p) { return p->declaration.tag != name; });
  if (!all.empty() && !common.json.empty()) return write_json(all, common.json);
  bool any = false;
  std::string list;
  Family last{};
  for (const Plugin* plugin : registry.all()) {
    const Declaration& d = plugin->declaration;
    if (!name.empty()) {
      if (d.tag == name) show(describe_plugin(*plugin)), any = true;
      continue;
    }
    if (!any || d.family != last)
      list += fmt::format("{}{}s\n", any ? "\n" : "", to_string(d.family));
    any = true, last = d.family;
    list += wrapped(d.summary, fmt::format("  {:<26} ", d.tag), std::string(29, ' '));
  }
  show(list);
  if (any) return;
  std::vector<std::string> tags;
  for (const Plugin* plugin : registry.all()) tags.push_back(plugin->declaration.tag);
  throw InputError({}, fmt::format("no plugin '{}'", name), "one of: " + join(tags),
                   nearest(name, tags));
}

}  // namespace

void add_plugins(CLI::App& app) {
  CLI::App* command =
      add_command(app, "plugins", "what is registered, with inputs, units and meaning");
  auto common = std::make_shared<Common>();
  auto name = std::make_shared<std::string>();
  command->add_option("name", *name, "a tag, to see its inputs");
  add_common(*command, *common, false, false);
  add_json(*command, *common);
  command->callback([=] { run(*name, *common); });
}

void add_schema(CLI::App& app) {
  CLI::App* command =
      add_command(app, "schema", "XML schema of everything registered, for editors and xmllint");
  auto common = std::make_shared<Common>();
  add_common(*command, *common, false, false);
  command->callback([=] { fmt::print("{}", xml_schema(common->registry())); });
}

}  // namespace talus
