#include "framework/model/model.h"

#include <algorithm>

namespace talus {

const Attribute* Element::find(std::string_view attribute) const {
  for (const Attribute& a : attributes)
    if (a.name == attribute) return &a;
  return nullptr;
}

std::string Element::text(std::string_view attribute, std::string_view otherwise) const {
  const Attribute* a = find(attribute);
  return a ? a->text : std::string(otherwise);
}

Element* Element::find_named(std::string_view name) {
  Element* limb = nullptr;
  for (Element& child : children) {
    if (child.name() != name) {
      if (Element* found = child.find_named(name)) return found;
    } else if (child.tag != "limb") {
      return &child;
    } else {
      limb = &child;
    }
  }
  return limb;
}

void Element::set(std::string_view attribute, std::string text) {
  for (Attribute& a : attributes)
    if (a.name == attribute) {
      a.text = std::move(text);
      return;
    }
  attributes.push_back({std::string(attribute), std::move(text), place});
}

bool same(const Element& a, const Element& b) {
  if (a.tag != b.tag || a.attributes.size() != b.attributes.size()) return false;
  for (const Attribute& attribute : a.attributes) {
    const Attribute* other = b.find(attribute.name);
    if (!other || other->text != attribute.text) return false;
  }
  return std::equal(a.children.begin(), a.children.end(), b.children.begin(), b.children.end(),
                    same);
}

}  // namespace talus
