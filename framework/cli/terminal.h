// What a user sees on a terminal, and nothing of it elsewhere: colours are added here, to finished
// text, where standard output or standard error is a terminal (--color, NO_COLOR). Results that are
// data (tables, JSON, models, pages) do not come through here.
#pragma once

#include <string>

#include "framework/model/error.h"

namespace talus {

enum class Colours { automatic, always, never };
Colours& colours();  // of --color

// A report: on standard output, the verdict's word and the headings standing out. A heading is a
// line that is not indented behind an empty one.
void show(const std::string& report);

// On standard error, behind what was shown: "Warning: ...", wrapped, no sentence twice.
void warn(const std::string& sentence);

// On standard error: "place: error: what was found ...".
void complain(const InputError& error);
void complain(const std::string& place, const std::string& what);

}  // namespace talus
