// Expressions in attributes of model files: `encoder1`, `-(q2 + q3)`, `2*L`, `encoder1 + 90 deg`.
//
//     sum     = product { (+|-) product }          product = factor { (*|/) factor }
//     factor  = [-] atom [^ number]
//     atom    = number [unit] | name | name.input | function(sum, ...) | ( sum )
//
// Dimensions are carried along: adding an angle to a plain number is an error that says which unit
// is missing. Functions: sin cos tan (angle -> number), asin acos atan2 (number -> angle), sqrt exp
// log abs sign less.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "framework/kinematics/expr.h"
#include "framework/model/error.h"
#include "framework/model/units.h"

namespace talus {

struct Term {
  Expr value;
  Dimension dimension;
};

// What a name stands for; throws InputError at `place` where it stands for nothing.
using Resolve = std::function<Term(const std::string& name, const Place& place)>;

Term parse_expression(std::string_view text, const Place& place, const Resolve& resolve);

}  // namespace talus
