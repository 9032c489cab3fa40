#include "framework/dsl/lua_source.h"

#include <algorithm>
#include <cctype>

#include "framework/dsl/lua_words.h"
#include "framework/dsl/text.h"

namespace talus {
namespace {

constexpr std::size_t nowhere = std::string_view::npos;

bool in_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

bool word_at(std::string_view text, std::size_t at, std::string_view word) {
  return text.substr(at).starts_with(word) && (at == 0 || !in_word(text[at - 1])) &&
         (at + word.size() == text.size() || !in_word(text[at + word.size()]));
}

std::size_t skip_spaces(std::string_view text, std::size_t at) {
  return std::min(text.find_first_not_of(" \t\r\n", at), text.size());
}

// The end of a string or comment that starts here, or `at` where none does.
std::size_t skip_quoted(std::string_view text, std::size_t at) {
  const bool comment = text.substr(at).starts_with("--");
  const std::size_t start = comment ? at + 2 : at;
  if (text.substr(start).starts_with("[[") || text.substr(start).starts_with("[=")) {
    const std::size_t level = text.find_first_not_of('=', start + 1) - start - 1;
    const std::string end = "]" + std::string(level, '=') + "]";
    if (start + 1 + level < text.size() && text[start + 1 + level] == '[')
      return std::min(text.find(end, start), text.size() - end.size()) + end.size();
  }
  if (comment) return std::min(text.find('\n', at), text.size());
  if (text[at] != '"' && text[at] != '\'') return at;
  std::size_t end = at + 1;
  while (end < text.size() && text[end] != text[at]) end += text[end] == '\\' ? 2 : 1;
  return std::min(end + 1, text.size());
}

}  // namespace

LuaSource::LuaSource(std::string_view text, std::string file)
    : text_(text), file_(std::move(file)), lines_{0} {
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') lines_.push_back(i + 1);
}

Place LuaSource::place(std::size_t at) const {
  const auto next = std::upper_bound(lines_.begin(), lines_.end(), at);
  const std::size_t start = *(next - 1);
  return {file_, static_cast<int>(next - lines_.begin()),
          characters(text_.substr(start, at - start)) + 1};
}

// The value of `key = value` directly inside the table of the call.
std::size_t LuaSource::find_value(std::size_t call, std::string_view key) const {
  int depth = 0;
  for (std::size_t at = text_.find('{', call); at < text_.size();) {
    if (const std::size_t end = skip_quoted(text_, at); end != at) {
      at = end;
      continue;
    }
    const char c = text_[at];
    const bool here = key[0] == '[' ? text_.substr(at).starts_with(key) : word_at(text_, at, key);
    if (depth == 1 && here) {
      const std::size_t after = skip_spaces(text_, at + key.size());
      if (text_.substr(after).starts_with('=') && !text_.substr(after).starts_with("=="))
        return skip_spaces(text_, after + 1);
    }
    if (c == '{' || c == '(' || c == '[') ++depth;
    if ((c == '}' || c == ')' || c == ']') && --depth == 0) return nowhere;
    ++at;
  }
  return nowhere;
}

bool LuaSource::literally(std::size_t value, std::string_view text) const {
  return value != nowhere && (text_[value] == '"' || text_[value] == '\'') &&
         text_.substr(value + 1).starts_with(text) &&
         text_.substr(value + 1 + text.size(), 1) == text_.substr(value, 1);
}

// The call of the element's tag on this line; among several, the one with the element's name.
std::size_t LuaSource::find_call(const Element& element, int line) const {
  if (line < 1 || line > static_cast<int>(lines_.size())) return nowhere;
  const std::size_t start = lines_[line - 1];
  const std::size_t end = std::min(text_.find('\n', start), text_.size());
  std::size_t first = nowhere;
  for (std::size_t at = start; at < end; ++at) {
    if (!word_at(text_, at, element.tag)) continue;
    std::size_t brace = skip_spaces(text_, at + element.tag.size());
    if (brace < text_.size() && text_[brace] == '(') brace = skip_spaces(text_, brace + 1);
    if (brace >= text_.size() || text_[brace] != '{') continue;
    if (first == nowhere) first = at;
    if (literally(find_value(at, "name"), element.name())) return at;
  }
  return first;
}

void LuaSource::locate(Element& element, int line) const {
  const std::size_t call = find_call(element, line);
  element.place = call == nowhere ? Place{file_, line, 0} : place(call);
  for (Attribute& a : element.attributes) {
    std::size_t value = nowhere;
    if (call != nowhere) value = find_value(call, lua_key(a.name));
    const bool exact = literally(value, a.text);
    a.place = value == nowhere ? element.place : place(exact ? value + 1 : value);
  }
}

}  // namespace talus
