// What `talus study` is told to try: values of attributes, and noises.
#pragma once

#include <string>
#include <vector>

namespace talus {

struct Varied {
  std::string name;                 // "joint2.d"
  std::vector<std::string> values;  // in the model file's own units
};
// "joint2.d=250:350:50; joint3.a=280,300"
std::vector<Varied> parse_vary(const std::string& text);

// Every combination of values, the last name changing fastest; one empty design where nothing is
// varied.
std::vector<std::vector<std::string>> designs_of(const std::vector<Varied>& varied);

// "0.005, 0.01, 0.025 deg", in rad. A unit at the end holds for all; without one they are degrees.
std::vector<double> parse_noise(const std::string& text);

}  // namespace talus
