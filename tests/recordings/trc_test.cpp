#include <doctest/doctest.h>

#include <cmath>

#include "framework/recordings/recordings.h"

using namespace talus;

namespace {

const std::string facts =
    "PathFileType\t4\t(X/Y/Z)\twalk.trc\n"
    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumF"
    "rames\n";
const std::string names =
    "Frame#\tTime\tLKNE\t\t\tR ankle\t\t\n"
    "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n";

std::string complaint(const std::string& text) {
  try {
    parse_trc(text, "walk.trc");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

}  // namespace

TEST_CASE("a marker file: each marker is a point, in the header's unit") {
  const Recordings r = parse_trc(facts + "100\t100\t2\t2\tm\t100\t1\t2\n" + names +
                                     "\n"
                                     "1\t0.00\t0.1\t0.2\t0.3\t0.4\t0.5\t0.6\t\n"
                                     "2\t0.01\t\t\t\tNaN\t-0.5\t6e-1\r\n",
                                 "walk.trc");
  REQUIRE(r.rows() == 2);
  REQUIRE(r.columns.size() == 8);
  CHECK(r.get("pose", number).values == std::vector<double>{1, 2});
  CHECK(r.get("time", duration).values == std::vector<double>{0, 0.01});
  CHECK(r.get("LKNE.y", length).values[0] == 200);
  CHECK(std::isnan(r.get("LKNE.y", length).values[1]));
  CHECK(std::isnan(r.get("R ankle.x", length).values[1]));
  CHECK(r.get("R ankle.y", length).values == std::vector<double>{500, -500});
  CHECK(r.get("R ankle.z", length).values == std::vector<double>{600, 600});
  CHECK(r.lines == std::vector<int>{7, 8});
}

TEST_CASE("complaints about marker files, to the letter") {
  const std::string mm = facts + "100\t100\t1\t2\tmm\t100\t1\t1\n";
  const std::string frame = "1\t0\t1\t2\t3\t4\t5\t6\n";
  CHECK(complaint(mm + names + frame) == "no complaint");
  CHECK(complaint("pose,a\n1,2\n") ==
        "walk.trc:1:1: 'pose,a' at the start of a marker file\n  expected PathFileType");
  CHECK(complaint(facts) ==
        "walk.trc:2: the file ends here\n  expected the values of DataRate ... Units");
  CHECK(complaint(facts + "100\t100\t1\t2\tmms\t100\t1\t1\n" + names + frame) ==
        "walk.trc:3:13: 'mms' is not a unit of length\n"
        "  expected a length (mm, m, um, cm, in)\n"
        "  did you mean 'mm'?");
  CHECK(complaint(facts + "100\t100\t1\t3\tmm\t100\t1\t1\n" + names + frame) ==
        "walk.trc:3: NumMarkers is 3, but there are 2 names\n  expected as many names as markers");
  CHECK(complaint(mm + names + frame + frame) ==
        "walk.trc:3: NumFrames is 1, but there are 2 frames\n"
        "  expected a complete file, or the number of frames there are");
  CHECK(complaint(mm + names + "1\t0\t1\t2\t3\t4\t5\n") ==
        "walk.trc:6:14: the row has 7 cells\n"
        "  expected 8 cells: frame, time and three for each of 2 markers");
  CHECK(complaint(mm + names + "1\t0\t1\t2\tx\t4\t5\t6\n") ==
        "walk.trc:6:9: 'x' in the column 'LKNE.z' is not a number\n"
        "  expected a number, or an empty cell where the value is missing");
  CHECK(complaint(mm + "Frame#\tTime\tA\t\tB\t\t\t\n\t\n" + frame) ==
        "walk.trc:4:16: the marker 'B' stands above the wrong column\n"
        "  expected a marker's name and two empty cells");
  CHECK(complaint(mm + "Frame#\tTime\tA\t\t\tA\t\t\n\t\n" + frame) ==
        "walk.trc:4:17: a second marker 'A'\n  expected a name of its own");
  CHECK(complaint(mm + names) ==
        "walk.trc:4: there are no frames below the header\n  expected one row per frame");
}
