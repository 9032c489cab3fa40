#include "framework/dsl/dsl.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "framework/dsl/read.h"
#include "framework/dsl/text.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

std::string identity(const std::string& file) {
  std::error_code ignored;
  return fs::weakly_canonical(fs::absolute(file), ignored).string();
}

Element parse(const std::string& text, const std::string& file, Registry& registry) {
  return file.ends_with(".lua") ? run_lua_model(text, file, registry) : parse_xml(text, file);
}

// Puts included files' children in place of <include> and loads what <plugin> names. Paths of
// plugins in included files are rewritten to be relative to the main file.
class Expander {
 public:
  Expander(Model& model, Registry& registry) : model_(model), registry_(registry) {}

  void run() {
    open_ = {model_.sources[0]};
    expand(model_.root);
  }

 private:
  void expand(Element& parent) {
    std::vector<Element> children;
    for (Element& child : parent.children) {
      const Attribute* file = child.find("file");
      if (child.tag == "include" && file) {
        for (Element& included : include(*file).children) children.push_back(std::move(included));
        continue;
      }
      if (child.tag == "plugin" && file) plugin(child, *file);
      expand(child);
      children.push_back(std::move(child));
    }
    parent.children = std::move(children);
  }

  Element include(const Attribute& attribute) {
    const std::string file = beside(open_.back(), attribute.text);
    for (const std::string& other : open_)
      if (identity(other) == identity(file))
        throw InputError(attribute.place, fmt::format("'{}' includes itself: {}", attribute.text,
                                                      join(open_, " -> ") + " -> " + file));
    if (!fs::exists(file))
      throw InputError(attribute.place, fmt::format("there is no file '{}'", file));
    Element root = parse(read_text(file), file, registry_);
    if (root.tag != "talus")
      throw InputError(root.place, "the root element is <" + root.tag + ">", "<talus>");
    for (auto [unit, otherwise] : {std::pair{"length", "mm"}, std::pair{"angle", "deg"}})
      if (const std::string ours = model_.root.text(unit, otherwise),
          theirs = root.text(unit, ours);
          ours != theirs)
        throw InputError(
            root.find(unit)->place,
            fmt::format("this file's {}s are in {}, those of {}, which includes it, in {}", unit,
                        theirs, model_.sources[0], ours),
            "the same unit in both");
    add_source(file);
    open_.push_back(file);
    expand(root);
    open_.pop_back();
    return root;
  }

  void plugin(Element& element, const Attribute& attribute) {
    const std::string file = beside(open_.back(), attribute.text);
    load_named_plugin(file, attribute.place, registry_);
    add_source(file);
    if (open_.size() > 1 && !fs::path(attribute.text).is_absolute())
      element.set("file",
                  fs::path(file).lexically_relative(beside(model_.sources[0], ".")).string());
  }

  void add_source(const std::string& file) {
    auto& all = model_.sources;
    if (std::find(all.begin(), all.end(), file) == all.end()) all.push_back(file);
  }

  Model& model_;
  Registry& registry_;
  std::vector<std::string> open_;  // the files being read, outermost first
};

Model finish(Element root, const std::string& file, Registry& registry) {
  Model model{std::move(root), {file}};
  Expander(model, registry).run();
  check_grammar(model, registry);
  return model;
}

bool loaded(const std::string& file, const Registry& registry) {
  const auto all = registry.all();
  return std::any_of(all.begin(), all.end(),
                     [&](const Plugin* p) { return identity(p->origin) == identity(file); });
}

// Runs a Lua plugin file; files that name each other in a circle are refused.
void load_lua(const std::string& file, const Place& place, Registry& registry) {
  static thread_local std::vector<std::string> open;
  if (std::find(open.begin(), open.end(), identity(file)) != open.end())
    throw InputError(place, fmt::format("the plugin file '{}' loads itself", file));
  struct Closing {
    ~Closing() { open.pop_back(); }
  };
  open.push_back(identity(file));
  Closing closing;
  run_lua_plugins(read_text(file), file, registry);
}

}  // namespace

Model read_xml(const std::string& text, const std::string& name, Registry& registry) {
  return finish(parse_xml(text, name), name, registry);
}

Model read_lua(const std::string& text, const std::string& name, Registry& registry) {
  return finish(run_lua_model(text, name, registry), name, registry);
}

Model read_model(const std::string& file, Registry& registry) {
  const bool lua = file.ends_with(".lua");
  const std::string text = read_text(file);
  if (!lua && !file.ends_with(".xml"))
    throw InputError({file, 0, 0}, "cannot tell the syntax of this file",
                     "a name ending in .xml or .lua");
  return lua ? read_lua(text, file, registry) : read_xml(text, file, registry);
}

void load_named_plugin(const std::string& file, const Place& place, Registry& registry) {
  if (loaded(file, registry)) return;
  if (!file.ends_with(".lua"))
    throw InputError(
        place, fmt::format("'{}' is not a Lua plugin file", file),
        "a name ending in .lua; a shared library is loaded only when the user names it: "
        "--plugin FILE.so");
  if (!fs::exists(file)) throw InputError(place, fmt::format("there is no plugin file '{}'", file));
  load_lua(file, place, registry);
}

void load_plugin(const std::string& file, Registry& registry) {
  if (loaded(file, registry)) return;
  if (file.ends_with(".lua")) return load_lua(file, {file, 0, 0}, registry);
  if (file.ends_with(".so")) return registry.load_library(file);
  throw InputError({file, 0, 0}, "cannot tell what kind of plugin this is",
                   "a name ending in .so or .lua");
}

void move_plugin_paths(Model& model, const std::string& from, const std::string& to) {
  for (Element& child : model.root.children)
    if (const std::string file = child.text("file");
        child.tag == "plugin" && !fs::path(file).is_absolute())
      child.set("file", fs::proximate(fs::absolute(beside(from, file)),
                                      fs::absolute(fs::path(folder_of(to)) / "."))
                            .string());
}

}  // namespace talus
