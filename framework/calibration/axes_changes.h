// What became of axes from one recording to others: changes of the four numbers of each axis, arc
// of the motion by arc, and their errors where the true changes are known (Bonny 2013, sec. 2.3 and
// Fig. 7).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "framework/calibration/axes.h"

namespace talus {

struct Arc {
  double first = 0, last = 0;  // rad
  std::string name;            // "20:80"
};
// "20:80, 30:90", in the model's unit of angle.
std::vector<Arc> parse_arcs(const std::string& text, const UnitSystem& units);

struct AxisChange {
  std::array<double, 4> value{}, std{};
  bool determined = true;  // in the reference and here
};

// Bias, precision (standard deviation), root mean square of measured minus actual changes.
struct ChangeErrors {
  int axis = 0, variable = 0;
  std::size_t count = 0;
  double bias = 0, precision = 0, rmse = 0;
};

// One arc (or the whole motion): the axes of every recording, the first being the reference.
struct ArcAxes {
  std::optional<Arc> arc;
  std::vector<Located> located;                  // per recording
  std::vector<std::vector<AxisChange>> changes;  // [recording after the first][axis]
  std::vector<ChangeErrors> errors;
};

struct AxesOptions {
  LocateOptions locate;
  std::string by;  // joint, its coordinate, or a column of the recordings: what the arcs are of
  bool anatomical = false;
  std::optional<std::size_t> zero;  // row of the first recording that shows zero flexion
  std::vector<Arc> arcs;
  std::vector<std::string> reverse;
  AxisLabels labels;
  std::function<void(double)> progress;  // share done
};

struct AxesResult {
  std::vector<View> views;
  ArcAxes whole;
  std::vector<ArcAxes> arcs;
  // Per variable that was judged: the arc with the largest root mean square error (-1: the whole
  // motion, where there are no arcs).
  struct Worst {
    int arc;
    ChangeErrors errors;
  };
  std::vector<Worst> worst;
};

// The name of a variable: "flexion.A-P".
std::string variable_name(const AxisFinder& finder, const AxesResult& result,
                          const AxisLabels& labels, int axis, int variable);

// `actual`: a table with one row per recording after the first and columns named as the variables
// are; those without a column are not judged.
AxesResult find_axes(AxisFinder& finder, const std::vector<Recordings>& recordings,
                     const AxesOptions& options, const Recordings* actual);

}  // namespace talus
