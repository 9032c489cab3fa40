#include <fmt/format.h>

#include "framework/dsl/dsl.h"
#include "framework/dsl/grammar.h"
#include "framework/dsl/text.h"

namespace talus {
namespace {

std::string annotation(const std::string& indent, const std::string& text) {
  return fmt::format("{}<xs:annotation><xs:documentation>{}</xs:documentation></xs:annotation>\n",
                     indent, xml_escape(text));
}

std::string attribute(const AttributeRule& rule) {
  std::string text = fmt::format("      <xs:attribute name=\"{}\"{}{}>\n", rule.name,
                                 rule.words.empty() ? " type=\"xs:string\"" : "",
                                 rule.required ? " use=\"required\"" : "");
  text += annotation("        ", rule.meaning);
  if (!rule.words.empty()) {
    text += "        <xs:simpleType><xs:restriction base=\"xs:string\">\n";
    for (const std::string& word : rule.words)
      text += fmt::format("          <xs:enumeration value=\"{}\"/>\n", xml_escape(word));
    text += "        </xs:restriction></xs:simpleType>\n";
  }
  return text + "      </xs:attribute>\n";
}

std::string children(const std::vector<ElementRule>& rules, Where where) {
  std::string text = "      <xs:choice minOccurs=\"0\" maxOccurs=\"unbounded\">\n";
  for (const ElementRule& rule : rules)
    if (rule.where == where || rule.tag == "include")
      text += fmt::format("        <xs:element ref=\"{}\"/>\n", rule.tag);
  return text + "      </xs:choice>\n";
}

}  // namespace

std::string xml_schema(const Registry& registry) {
  const auto rules = all_rules(registry);
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<xs:schema xmlns:xs=\"http://www.w3.org/2001/XMLSchema\">\n";
  for (const ElementRule& rule : rules) {
    text += fmt::format("  <xs:element name=\"{}\">\n", rule.tag);
    text += annotation("    ", rule.meaning);
    text += "    <xs:complexType>\n";
    if (rule.tag == "talus") text += children(rules, Where::inside_talus);
    if (rule.tag == "chain") text += children(rules, Where::inside_chain);
    for (const AttributeRule& a : rule.attributes) text += attribute(a);
    text += "    </xs:complexType>\n  </xs:element>\n";
  }
  return text + "</xs:schema>\n";
}

}  // namespace talus
