// A model as plain data: a tree of elements, each with a tag, attributes and children, exactly as
// the user wrote them in XML or Lua. Nothing is interpreted here: what a tag or an attribute means
// is known to the plugin registered under that tag, and is worked out when the model is compiled.
//
//     <talus name="pendulum" length="mm" angle="deg">
//       <chain from="base" to="tip"> <dh name="joint1" theta="encoder1" a="300 ± 0.5"/> </chain>
//     </talus>
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/model/error.h"

namespace talus {

struct Attribute {
  std::string name;
  std::string text;
  Place place;
};

struct Element {
  std::string tag;
  std::vector<Attribute> attributes;
  std::vector<Element> children;
  Place place;

  const Attribute* find(std::string_view attribute) const;
  std::string text(std::string_view attribute, std::string_view otherwise = {}) const;
  std::string name() const { return text("name"); }
  // Among all below; a limb only where nothing else has the name, since it may have its frame's.
  Element* find_named(std::string_view name);
  void set(std::string_view attribute, std::string text);  // keeps the place of what it replaces
};

struct Model {
  Element root;                      // tag "talus"
  std::vector<std::string> sources;  // the files it came from, the main one first
};

// Equal in tags, attributes (in any order) and children (in order); places do not matter.
bool same(const Element& a, const Element& b);

}  // namespace talus
