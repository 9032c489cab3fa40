// Small helpers on the text of model files.
#pragma once

#include <string>
#include <string_view>

#include "framework/model/error.h"

namespace talus {

// The whole file, checked to be UTF-8; InputError where it cannot be read.
std::string read_text(const std::string& file);

// InputError at the first byte that is not UTF-8 (or is a zero).
void check_utf8(std::string_view text, const std::string& file);

bool is_utf8(std::string_view text);

// With &, <, >, " and control characters replaced by references.
std::string xml_escape(std::string_view text);

// Number of characters (not bytes).
int characters(std::string_view utf8);

// The part of a file's path before its name: "" or "models/".
std::string folder_of(const std::string& file);

// The path of `relative`, which holds beside `file`.
std::string beside(const std::string& file, const std::string& relative);

}  // namespace talus
