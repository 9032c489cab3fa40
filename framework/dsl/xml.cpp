#include <fmt/format.h>
#include <tinyxml2.h>

#include "framework/dsl/read.h"
#include "framework/dsl/text.h"

namespace talus {
namespace {

// The parser knows lines only. This walks the start tags of the same text in the same order and
// finds the exact place of each and of each of its attributes' values.
class Locator {
 public:
  Locator(std::string_view text, const std::string& file) : rest_(text), here_{file, 1, 1} {}

  // The place of the next element's start; the places of its attributes' values go to `values`.
  Place next(std::vector<Place>& values) {
    values.clear();
    while (!rest_.empty()) {
      skip_to("<");
      if (rest_.starts_with("<!--"))
        skip_past("-->");
      else if (rest_.starts_with("<![CDATA["))
        skip_past("]]>");
      else if (rest_.starts_with("<?"))
        skip_past("?>");
      else if (rest_.starts_with("</") || rest_.starts_with("<!"))
        skip_past(">");
      else
        break;
    }
    const Place start = here_;
    skip_to_any(" \t\r\n/>");
    while (true) {
      skip_spaces();
      if (rest_.empty() || rest_[0] == '>' || rest_[0] == '/') return start;
      skip_to_any("\"'");
      if (rest_.empty()) return start;
      const std::string quote(1, rest_[0]);
      advance(1);
      values.push_back(here_);
      skip_past(quote);
    }
  }

 private:
  void advance(std::size_t bytes) {
    for (char c : rest_.substr(0, bytes)) {
      if (c == '\n')
        ++here_.line, here_.column = 1;
      else if ((c & 0xC0) != 0x80)
        ++here_.column;
    }
    rest_.remove_prefix(std::min(bytes, rest_.size()));
  }
  void skip_to(std::string_view what) { advance(std::min(rest_.find(what), rest_.size())); }
  void skip_past(std::string_view what) { skip_to(what), advance(what.size()); }
  void skip_to_any(const char* set) { advance(std::min(rest_.find_first_of(set), rest_.size())); }
  void skip_spaces() { advance(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size())); }

  std::string_view rest_;
  Place here_;
};

class Reader {
 public:
  Reader(std::string_view text, const std::string& file) : file_(file), locator_(text, file) {}

  Element element(const tinyxml2::XMLElement& xml) {
    Element e{xml.Name()};
    std::vector<Place> places;
    e.place = locator_.next(places);
    std::size_t i = 0;
    for (auto* a = xml.FirstAttribute(); a; a = a->Next(), ++i) {
      const Place place = i < places.size() ? places[i] : Place{file_, a->GetLineNum(), 0};
      e.attributes.push_back({a->Name(), a->Value(), place});
    }
    for (auto* node = xml.FirstChild(); node; node = node->NextSibling())
      if (auto* child = node->ToElement())
        e.children.push_back(element(*child));
      else
        refuse_unless_comment(*node, "<" + e.tag + ">");
    return e;
  }

  void refuse_unless_comment(const tinyxml2::XMLNode& node, const std::string& where) const {
    const Place place{file_, node.GetLineNum(), 0};
    if (node.ToText()) {
      std::string text = node.Value();
      text.erase(0, text.find_first_not_of(" \t\r\n"));
      text.erase(text.find_last_not_of(" \t\r\n") + 1);
      if (characters(text) > 30) text = text.substr(0, text.find_last_of(' ', 30)) + " ...";
      throw InputError(place, fmt::format("text '{}' stands inside {}", text, where),
                       "attributes and elements only; remarks go into <!-- comments -->");
    }
    if (node.ToUnknown())
      throw InputError(place, fmt::format("'<!{}>' is not understood", node.Value()),
                       "elements and comments only");
  }

 private:
  std::string file_;
  Locator locator_;
};

[[noreturn]] void syntax_error(const tinyxml2::XMLDocument& document, const std::string& file) {
  const Place place{file, document.ErrorLineNum(), 0};
  const std::string all = document.ErrorStr();
  const std::size_t at = all.find("name=");
  const std::string tag = at == std::string::npos ? "" : "<" + all.substr(at + 5) + ">";
  switch (document.ErrorID()) {
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      throw InputError({file, 0, 0}, "the file has no elements", "<talus> ... </talus>");
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      throw InputError(place, tag + " is not closed where it should be",
                       tag.empty() ? "" : "</" + tag.substr(1));
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      throw InputError(place, "the attributes of " + tag + " cannot be read",
                       "name=\"value\" pairs, each name once");
    case tinyxml2::XML_ERROR_PARSING_COMMENT:
      throw InputError(place, "a comment is not closed", "-->");
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      throw InputError(place, "elements are nested too deeply");
    default:
      throw InputError(place, "an element cannot be read",
                       "<tag name=\"value\"/> or <tag> ... </tag>");
  }
}

}  // namespace

Element parse_xml(const std::string& text, const std::string& file) {
  check_utf8(text, file);
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    syntax_error(document, file);
  Reader reader(text, file);
  const tinyxml2::XMLElement* root = document.RootElement();
  if (!root) throw InputError({file, 0, 0}, "the file has no elements", "<talus> ... </talus>");
  for (auto* node = document.FirstChild(); node; node = node->NextSibling()) {
    if (node->ToElement() && node != root)
      throw InputError({file, node->GetLineNum(), 0},
                       fmt::format("a second root, <{}>", node->Value()),
                       "one <talus> holding everything");
    reader.refuse_unless_comment(*node, "the file");
  }
  return reader.element(*root);
}

}  // namespace talus
