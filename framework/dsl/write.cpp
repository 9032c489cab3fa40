#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "framework/dsl/dsl.h"
#include "framework/dsl/lua_words.h"
#include "framework/dsl/text.h"

namespace talus {
namespace {

using Cells = std::vector<std::string>;

// The attributes as they are written, `name` first.
Cells cells(const Element& e, std::string (*write)(const Attribute&)) {
  Cells result;
  for (const Attribute& a : e.attributes)
    if (a.name == "name") result.push_back(write(a));
  for (const Attribute& a : e.attributes)
    if (a.name != "name") result.push_back(write(a));
  return result;
}

bool same_shape(const Element& a, const Element& b) {
  return a.tag == b.tag && a.children.empty() && b.children.empty() &&
         std::equal(a.attributes.begin(), a.attributes.end(), b.attributes.begin(),
                    b.attributes.end(),
                    [](const Attribute& x, const Attribute& y) { return x.name == y.name; });
}

// The cells of all children, those of neighbours with the same attributes padded to columns.
std::vector<Cells> table(const std::vector<Element>& children,
                         std::string (*write)(const Attribute&)) {
  std::vector<Cells> rows;
  for (const Element& child : children) rows.push_back(cells(child, write));
  for (std::size_t first = 0, last; first < rows.size(); first = last) {
    for (last = first + 1; last < rows.size() && same_shape(children[first], children[last]);)
      ++last;
    for (std::size_t column = 0; column + 1 < rows[first].size(); ++column) {
      int width = 0;
      for (std::size_t i = first; i < last; ++i)
        width = std::max(width, characters(rows[i][column]));
      for (std::size_t i = first; i < last; ++i)
        rows[i][column].append(width - characters(rows[i][column]), ' ');
    }
  }
  return rows;
}

std::string xml_attribute(const Attribute& a) {
  return fmt::format("{}=\"{}\"", a.name, xml_escape(a.text));
}

void xml_element(std::string& out, const Element& e, const Cells& attributes,
                 const std::string& indent) {
  out += indent + "<" + e.tag;
  for (const std::string& a : attributes) out += " " + a;
  if (e.children.empty()) {
    out += "/>\n";
    return;
  }
  out += ">\n";
  const auto rows = table(e.children, xml_attribute);
  for (std::size_t i = 0; i < rows.size(); ++i)
    xml_element(out, e.children[i], rows[i], indent + "  ");
  out += indent + "</" + e.tag + ">\n";
}

std::string lua_text(std::string_view text) {
  std::string result = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\')
      result += {'\\', c};
    else if (c == '\n')
      result += "\\n";
    else if (static_cast<unsigned char>(c) < 0x20)
      result += fmt::format("\\{:03}", int(c));
    else
      result += c;
  }
  return result + '"';
}

// The comma stands in the cell, so that it follows the value directly.
std::string lua_attribute(const Attribute& a) {
  return fmt::format("{} = {},", lua_key(a.name), lua_text(a.text));
}

void lua_element(std::string& out, const Element& e, const Cells& attributes,
                 const std::string& indent, const char* after) {
  out += e.tag + " {";
  for (const std::string& a : attributes) out += " " + a;
  if (e.children.empty()) {
    if (!attributes.empty()) out.back() = ' ';  // its comma
    out += std::string("}") + after + "\n";
    return;
  }
  out += "\n";
  const auto rows = table(e.children, lua_attribute);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    out += indent + "  ";
    lua_element(out, e.children[i], rows[i], indent + "  ", ",");
  }
  out += indent + "}" + after + "\n";
}

}  // namespace

std::string lua_key(std::string_view attribute) {
  if (is_lua_keyword(attribute)) return std::string(attribute) + "_";
  const bool word = !attribute.empty() && !std::isdigit(static_cast<unsigned char>(attribute[0])) &&
                    std::all_of(attribute.begin(), attribute.end(), [](unsigned char c) {
                      return c < 0x80 && (std::isalnum(c) || c == '_');
                    });
  return word ? std::string(attribute) : "[" + lua_text(attribute) + "]";
}

std::string attribute_of_lua_key(std::string_view key) {
  if (key.ends_with('_') && is_lua_keyword(key.substr(0, key.size() - 1))) key.remove_suffix(1);
  return std::string(key);
}

bool is_lua_keyword(std::string_view word) {
  static constexpr std::array<std::string_view, 22> words = {
      "and",      "break",  "do",   "else", "elseif", "end",  "false", "for",
      "function", "goto",   "if",   "in",   "local",  "nil",  "not",   "or",
      "repeat",   "return", "then", "true", "until",  "while"};
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string write_xml(const Model& model) {
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  xml_element(out, model.root, cells(model.root, xml_attribute), "");
  return out;
}

std::string write_lua(const Model& model) {
  std::string out = "return ";
  lua_element(out, model.root, cells(model.root, lua_attribute), "", "");
  return out;
}

}  // namespace talus
