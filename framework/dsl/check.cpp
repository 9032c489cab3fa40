#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>

#include "framework/dsl/dsl.h"
#include "framework/dsl/grammar.h"

namespace talus {
namespace {

std::string one_of(const std::vector<std::string>& words) {
  return (words.size() > 1 ? "one of: " : "") + join(words);
}

// "<dh name="joint1">"
std::string shown(const Element& element) {
  const std::string name = element.name();
  return name.empty() ? "<" + element.tag + ">"
                      : fmt::format("<{} name=\"{}\">", element.tag, name);
}

class Checker {
 public:
  explicit Checker(const Registry& registry) : registry_(registry) {}

  void run(const Element& root) {
    if (root.tag != "talus")
      throw InputError(root.place, "the root element is <" + root.tag + ">", "<talus>");
    element(root, Where::root, nullptr);
  }

 private:
  // `parent` is null for the root.
  void element(const Element& e, Where where, const Element* parent) {
    const auto rule = rule_of(e.tag, registry_);
    if (!rule) unknown_tag(e, where);
    if (rule->where != where && e.tag != "include") misplaced(e, *rule, *parent);
    attributes(e, *rule);
    if (e.tag == "talus") units(e);
    if (e.tag == "calibrate") calibrate(e);
    if (where != Where::root) name(e);
    if (!e.children.empty() && e.tag != "talus" && e.tag != "chain")
      throw InputError(
          e.children[0].place,
          fmt::format("<{}> stands inside {}, which has no children", e.children[0].tag, shown(e)));
    for (const Element& child : e.children)
      element(child, e.tag == "chain" ? Where::inside_chain : Where::inside_talus, &e);
  }

  [[noreturn]] void unknown_tag(const Element& e, Where where) const {
    if (registry_.find(e.tag, Family::residual))
      throw InputError(
          e.place, fmt::format("<{}> is a residual, not an element", e.tag),
          fmt::format("it to be named by a calibrate: <calibrate residual=\"{}\" of=\"...\"/>",
                      e.tag));
    std::vector<std::string> here, anywhere;
    for (const ElementRule& rule : all_rules(registry_)) {
      anywhere.push_back(rule.tag);
      if (rule.where == where) here.push_back(rule.tag);
    }
    std::string meant = nearest(e.tag, here);
    if (meant.empty()) meant = nearest(e.tag, anywhere);
    throw InputError(e.place, fmt::format("no element <{}> is known", e.tag),
                     meant.empty() ? one_of(here) : "", meant);
  }

  [[noreturn]] static void misplaced(const Element& e, const ElementRule& rule,
                                     const Element& parent) {
    static constexpr const char* places[] = {"it as the root only", "it directly inside <talus>",
                                             "it inside a <chain>"};
    throw InputError(e.place, fmt::format("{} may not stand inside {}", shown(e), shown(parent)),
                     places[static_cast<int>(rule.where)]);
  }

  static void attributes(const Element& e, const ElementRule& rule) {
    for (const Attribute& a : e.attributes) {
      if (a.name.starts_with("xmlns") || a.name.starts_with("xsi:"))
        continue;  // an editor's schema
      const AttributeRule* known = rule.find(a.name);
      if (!known)
        throw InputError(a.place, fmt::format("<{}> has no attribute '{}'", e.tag, a.name),
                         one_of(rule.names()), nearest(a.name, rule.names()));
      const auto& words = known->words;
      if (!words.empty() && std::find(words.begin(), words.end(), a.text) == words.end())
        throw InputError(a.place, fmt::format("{} of {} cannot be '{}'", a.name, shown(e), a.text),
                         one_of(words), nearest(a.text, words));
    }
    for (const AttributeRule& wanted : rule.attributes)
      if (wanted.required && !e.find(wanted.name))
        throw InputError(e.place, fmt::format("{} lacks the attribute '{}'", shown(e), wanted.name),
                         fmt::format("{}: {}", wanted.name, wanted.meaning));
  }

  static void units(const Element& root) {
    for (auto [attribute, dimension] : {std::pair{"length", length}, std::pair{"angle", angle}})
      if (const Attribute* a = root.find(attribute)) {
        const auto unit = parse_unit(a->text);
        if (!unit || unit->dimension != dimension)
          throw InputError(a->place, fmt::format("'{}' is no unit of {}", a->text, attribute),
                           dimension == length ? "one of: mm, m, cm, um, in"
                                               : "one of: deg, rad, mrad, arcmin, arcsec");
      }
  }

  void calibrate(const Element& e) const {
    const Attribute& residual = *e.find("residual");
    const auto known = registry_.tags(Family::residual);
    std::vector<std::string> allowed;
    for (const std::string& tag : split_list(residual.text)) {
      const Plugin* plugin = registry_.find(tag, Family::residual);
      if (!plugin)
        throw InputError(residual.place, fmt::format("no residual '{}' is known", tag),
                         one_of(known), nearest(tag, known));
      for (const Input& input : plugin->declaration.inputs) {
        allowed.push_back(input.name);
        if (input.required && !e.find(input.name))
          throw InputError(e.place, fmt::format("<calibrate> lacks the attribute '{}'", input.name),
                           fmt::format("{}: {} (residual {})", input.name, input.meaning, tag));
      }
    }
    for (const std::string& tag : known)
      for (const Input& input : registry_.find(tag, Family::residual)->declaration.inputs)
        if (const Attribute* a = e.find(input.name);
            a && std::find(allowed.begin(), allowed.end(), input.name) == allowed.end())
          throw InputError(
              a->place, fmt::format("'{}' is an input of the residual {}, which is not named here",
                                    input.name, tag));
    if (const Attribute* loss = e.find("loss")) {
      const std::string word = loss->text.substr(0, loss->text.find(' '));
      if (word != "huber" && word != "cauchy")
        throw InputError(loss->place, fmt::format("loss of <calibrate> cannot be '{}'", loss->text),
                         "huber or cauchy with its scale in sigmas: huber 2",
                         nearest(word, {"huber", "cauchy"}));
    }
  }

  // Expressions call joints, sensors and numbers by name; a measured feature and a limb may be
  // named like the frame they belong to.
  void name(const Element& e) {
    const Attribute* a = e.find("name");
    if (!a) return;
    const bool word = !a->text.empty() && !std::isdigit(static_cast<unsigned char>(a->text[0])) &&
                      std::all_of(a->text.begin(), a->text.end(),
                                  [](unsigned char c) { return std::isalnum(c) || c == '_'; });
    if (!word)
      throw InputError(a->place, fmt::format("'{}' cannot be a name", a->text),
                       "letters, digits and '_', with no digit first");
    auto& taken = registry_.find(e.tag, Family::feature) ? features_
                  : e.tag == "limb"                      ? limbs_
                                                         : names_;
    auto [other, fresh] = taken.try_emplace(a->text, &e);
    if (!fresh)
      throw InputError(a->place, fmt::format("the name '{}' is given twice", a->text),
                       fmt::format("another one than that of <{}> at {}", other->second->tag,
                                   to_string(other->second->place)));
  }

  const Registry& registry_;
  std::map<std::string, const Element*> names_, features_, limbs_;
};

}  // namespace

void check_grammar(const Model& model, const Registry& registry) {
  Checker(registry).run(model.root);
}

}  // namespace talus
