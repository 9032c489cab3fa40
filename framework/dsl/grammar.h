// What may be written where. One rule per element, structural or plugin, with its attributes in the
// order in which they are listed and explained; a plugin's rule is made from its declaration. The
// checker, the XML schema and the Lua constructors all work from these rules.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/registry/registry.h"

namespace talus {

struct AttributeRule {
  std::string name;
  std::string meaning;
  bool required = false;
  std::vector<std::string> words = {};  // the only texts allowed; empty: any text
};

enum class Where { root, inside_talus, inside_chain };

struct ElementRule {
  std::string tag;
  std::string meaning;
  Where where = Where::inside_talus;
  std::vector<AttributeRule> attributes;

  const AttributeRule* find(std::string_view attribute) const;
  std::vector<std::string> names() const;  // of the attributes
};

// The rule of a tag, or nothing where no such element is known. Residuals are no elements; their
// inputs stand on `calibrate`, whose rule allows those of every residual.
std::optional<ElementRule> rule_of(std::string_view tag, const Registry& registry);

// Every rule: the structural elements, then the plugins by family.
std::vector<ElementRule> all_rules(const Registry& registry);

// What a plugin may not use: the tag of a structural element, or as an input's name an attribute
// that all elements of its family (for residuals: `calibrate`) have.
bool is_structural(std::string_view tag);
bool is_reserved(std::string_view input, Family family);

// Lists of names such as residual="position, rotation_vector".
std::vector<std::string> split_list(std::string_view text);

}  // namespace talus
