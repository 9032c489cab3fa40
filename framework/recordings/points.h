// Raw points of a coordinate measuring machine: one row per probed point, in the machine's axes.
//
//     pose,feature,x[mm],y[mm],z[mm]
//     1,B_face,12.014,40.001,-3.250
//
// Points of one shape at one pose stand in the order in which they were probed, which gives the
// shape's axis its sense.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "framework/model/error.h"

namespace talus {

struct Points {
  struct Row {
    int line = 0;
    double pose = 0;
    std::string feature;
    std::array<double, 3> at{};  // mm
  };
  std::string file;
  std::vector<Row> rows;
};

Points read_points(const std::string& file);
Points parse_points(std::string_view text, const std::string& file);
std::string write_points(const Points& points);

}  // namespace talus
