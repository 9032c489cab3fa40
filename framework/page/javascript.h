// Expressions of a tape as JavaScript, so that a page moves exactly the linkage that was fitted,
// whatever plugins it is made of: those written in Lua leave the same tape as those in C++.
//
//     function(s,o){const a=s[3],b=Math.sin(a);o[0]=b;}
//
// `s` holds the slots' values (internal units), `o` receives the wanted ones. The text is written
// into the page as a script, so that no text has to be turned into code there. Numbers are written
// so that they are read back unchanged.
#pragma once

#include <string>
#include <vector>

#include "framework/kinematics/expr.h"

namespace talus {

std::string javascript(const Tape& tape, const std::vector<std::int32_t>& wanted);

}  // namespace talus
