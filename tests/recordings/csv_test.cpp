#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "framework/recordings/recordings.h"

using namespace talus;

namespace {

std::string complaint(std::string_view text) {
  try {
    parse_recordings(text, "r.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

std::string complaint(const Recordings& recordings, const char* column, Dimension dimension) {
  try {
    recordings.get(column, dimension);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

std::vector<double> values(std::string_view text, const char* column) {
  return parse_recordings(text, "r.csv").find(column)->values;
}

}  // namespace

TEST_CASE("a table with units, comments, a missing value and the column use") {
  const Recordings r = parse_recordings(
      "# arm, calibrated in spring\n"
      "pose, time[s] ,theta1[deg],E.x[m],E.qw,temperature[K],use\n"
      "1,0.5,180,0.3,1,293.15,fit\n"
      "\n"
      "  # a comment in between; it may be \xE4ncient\n"
      "2,60,,+3e-1,,273.15,check\n",
      "r.csv");
  REQUIRE(r.rows() == 2);
  REQUIRE(r.columns.size() == 6);
  CHECK(r.header_line == 2);
  CHECK(r.lines == std::vector<int>{3, 6});
  CHECK(r.get("pose", number).values == std::vector<double>{1, 2});
  CHECK(r.get("time", duration).values == std::vector<double>{0.5, 60});
  CHECK(r.get("theta1", angle).values[0] == doctest::Approx(std::acos(-1.0)).epsilon(1e-15));
  CHECK(std::isnan(r.get("theta1", angle).values[1]));
  CHECK(r.get("E.x", length).values == std::vector<double>{300, 300});
  CHECK(std::isnan(r.get("E.qw", number).values[1]));
  CHECK(r.get("temperature", temperature).values[0] == doctest::Approx(20));
  CHECK(r.use.value() == std::vector<bool>{true, false});
  CHECK(r.find("use") == nullptr);
  CHECK(r.get("E.x", length).place.line == 2);
  CHECK(r.get("E.x", length).place.column == 28);
}

TEST_CASE("however the lines end and whatever the spreadsheet adds") {
  for (const char* text :
       {"pose,a[mm]\n1,2\n3,4\n", "pose,a[mm]\r\n1,2\r\n3,4", "pose,a[mm]\r1,2\r3,4\r",
        "\xEF\xBB\xBFpose,a[mm]\n1,2\n3,4\n", "\"pose\",\"a[mm]\"\n\"1\",\"2\"\n3, \"4\" \n",
        "pose,a [mm]\n1\t,\t2\n,,\n3,4\n,\n\n"}) {
    CAPTURE(text);
    CHECK(values(text, "pose") == std::vector<double>{1, 3});
    CHECK(values(text, "a") == std::vector<double>{2, 4});
  }
}

TEST_CASE("complaints about the header, to the letter") {
  const std::string expected_header = "  expected a header row, such as pose,theta1[deg],E.x[mm]";
  CHECK(complaint("") == "r.csv: the file is empty\n" + expected_header);
  CHECK(complaint("\n \n") == "r.csv: the file is empty\n" + expected_header);
  CHECK(complaint("# nothing\n") == "r.csv:1:1: there are only comments\n" + expected_header);
  CHECK(complaint("1,2.5\n3,4\n") == "r.csv:1:1: the first row holds numbers\n" + expected_header);
  CHECK(complaint("pose,a\n") ==
        "r.csv:1: there are no rows below the header\n  expected one row per pose");
  CHECK(complaint("pose,theta1[degrees]\n1,2\n") ==
        "r.csv:1:13: 'degrees' is not a unit\n"
        "  expected one of: mm, m, um, cm, in, deg, rad, mrad, arcmin, arcsec, s, ms, min, h, "
        "degC, K, kg, g, N, "
        "count, 1, or a product such as N*mm\n"
        "  did you mean 'deg'?");
  CHECK(complaint("θ[deg],b[°]\n1,2\n").starts_with("r.csv:1:10: '°' is not a unit\n"));
  CHECK(complaint("pose,theta1(deg)\n1,2\n") ==
        "r.csv:1:12: the unit in 'theta1(deg)' is in round brackets\n"
        "  expected square brackets\n"
        "  did you mean 'theta1[deg]'?");
  CHECK(complaint("pose,a[mm,b\n1,2,3\n") ==
        "r.csv:1:7: the bracket in 'a[mm' is not closed\n  expected a[unit]");
  CHECK(complaint("pose,a[mm]x\n1,2\n") ==
        "r.csv:1:11: 'x' after the unit\n  expected ',' or the end of the line");
  CHECK(complaint("pose,a mm]\n1,2\n") ==
        "r.csv:1:10: ']' without '['\n  expected a name, such as theta1[deg]");
  CHECK(complaint("pose,a[mm],,b\n1,2,3,4\n") ==
        "r.csv:1:12: column 3 has no name\n  expected a name, such as theta1[deg]");
  CHECK(complaint("pose,a[mm],a[m]\n1,2,3\n") ==
        "r.csv:1:12: a second column 'a'\n  expected a name of its own (column 2 has this one)");
  CHECK(complaint("pose;a[mm];b[mm]\n1;2,5;3\n") ==
        "r.csv:1:5: the cells are separated by ';'\n  expected ',' between cells and '.' before "
        "decimals");
  CHECK(complaint("pose\ta[mm]\n1\t2\n") ==
        "r.csv:1:5: the cells are separated by a tab\n  expected ',' between cells and '.' before "
        "decimals");
  CHECK(complaint("pose,use[1]\n1,fit\n") ==
        "r.csv:1:9: a unit on the column 'use'\n  expected the column use, with the words fit and "
        "check");
}

TEST_CASE("complaints about cells, to the letter") {
  const std::string header = "pose,θ[deg],use\n";
  const std::string expected_number =
      "  expected a number, or an empty cell where the value is missing";
  CHECK(complaint(header + "1,abc,fit\n") ==
        "r.csv:2:3: 'abc' in the column 'θ' is not a number\n" + expected_number);
  CHECK(complaint(header + "1, nan,fit\n") ==
        "r.csv:2:4: 'nan' in the column 'θ' is not a number\n" + expected_number);
  CHECK(complaint(header + "1,-inf,fit\n") ==
        "r.csv:2:3: '-inf' in the column 'θ' is not a number\n" + expected_number);
  CHECK(complaint(header + "1,\"27,05\",fit\n") ==
        "r.csv:2:4: '27,05' in the column 'θ' is not a number\n"
        "  expected a decimal point\n"
        "  did you mean '27.05'?");
  CHECK(complaint(header + "1,−3,fit\n") ==
        "r.csv:2:3: '−3' in the column 'θ' is not a number\n"
        "  expected an ASCII minus sign\n"
        "  did you mean '-3'?");
  CHECK(complaint(header + "1,3 rad,fit\n") ==
        "r.csv:2:3: '3 rad' in the column 'θ' is not a number\n"
        "  expected the unit in the header, as θ[rad]");
  CHECK(complaint(header + "1,2,fit\n2,3\n") ==
        "r.csv:3:4: the row has 2 cells\n  expected 3 cells, as in the header of line 1");
  CHECK(complaint(header + "1,27,05,fit\n") ==
        "r.csv:2:9: the row has 4 cells\n"
        "  expected 3 cells, as in the header of line 1; a decimal comma makes two cells of one "
        "number");
  CHECK(complaint(header + "1;2;fit\n") ==
        "r.csv:2:8: the row has 1 cell\n  expected 3 cells, as in the header of line 1, separated "
        "by ','");
  CHECK(complaint(header + "1,2,chekc\n") ==
        "r.csv:2:5: 'chekc' in the column 'use'\n  expected fit or check\n  did you mean 'check'?");
  CHECK(complaint(header + "1,2,\n") ==
        "r.csv:2:5: an empty cell in the column 'use'\n  expected fit or check");
  CHECK(complaint(header + "1,\"2,fit\n") ==
        "r.csv:2:3: the quotation mark is not closed on its line\n  expected a second '\"'");
}

TEST_CASE("what is not text in UTF-8") {
  CHECK(complaint(std::string_view("\xFF\xFEp\0o\0", 6)) ==
        "r.csv: the file is UTF-16\n  expected a file saved as UTF-8");
  CHECK(complaint(std::string_view("pose\n1\0", 7)) ==
        "r.csv: the file is not text\n  expected a header row, such as pose,theta1[deg],E.x[mm]");
  CHECK(complaint("pose,l\xE4nge[mm]\n1,2\n") ==
        "r.csv:1:7: the byte 0xE4 is not UTF-8\n  expected a file saved as UTF-8");
  CHECK(complaint("pose,a[mm]\n1,2\xB0\x1B[31m\n") ==
        "r.csv:2:3: '2\\xB0\\x1B[31m' in the column 'a' is not a number\n"
        "  expected a number, or an empty cell where the value is missing");
}

TEST_CASE("what is never read as a number") {
  for (const char* cell : {"1e999", "NaN", "NAN", "Infinity", "0x1F", "1.2.3", "1e", "--1", "+-1",
                           "+", "-", "NA", "1 2", "1_000", "1'000", "$1", "1%", "fit"}) {
    CAPTURE(cell);
    CHECK_THROWS_AS(parse_recordings(std::string("pose,a\n1,") + cell + "\n", "r.csv"), InputError);
  }
}

TEST_CASE("a column asked for by name and dimension") {
  const Recordings r =
      parse_recordings("# x\npose,theta1[mm],theta2,E.x[mm],F[N]\n1,2,3,4,5\n", "r.csv");
  CHECK(complaint(r, "theat1", angle) ==
        "r.csv:2: there is no column 'theat1'\n"
        "  expected one of: pose, theta1, theta2, E.x, F\n"
        "  did you mean 'theta1'?");
  CHECK(complaint(r, "theta1", angle) ==
        "r.csv:2:6: the column 'theta1' is in mm, a length\n"
        "  expected an angle: the column theta1[deg] or theta1[rad]");
  CHECK(complaint(r, "theta2", angle) ==
        "r.csv:2:17: the column 'theta2' has no unit\n"
        "  expected an angle: the column theta2[deg] or theta2[rad]");
  CHECK(
      complaint(r, "E.x", number) ==
      "r.csv:2:24: the column 'E.x' is in mm, a length\n  expected a plain number: the column E.x");
  CHECK(complaint(r, "F", torque) ==
        "r.csv:2:32: the column 'F' is in N, a force\n"
        "  expected a torque: the column F[N*m]");
  CHECK(complaint(r, "E.x", length) == "no complaint");
}

TEST_CASE("what is written reads back as the same numbers") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1000, 1000);
  std::string text = "pose,a[mm],b[deg],c[K],d[N*mm],use\n";
  for (int i = 0; i < 500; ++i) {
    text += std::to_string(i);
    for (int k = 0; k < 4; ++k) text += "," + (i % 50 == k ? "" : std::to_string(uniform(random)));
    text += i % 3 == 0 ? ",check\n" : ",fit\n";
  }
  const Recordings r = parse_recordings(text, "r.csv");
  const std::string written = write_recordings(r);
  const Recordings back = parse_recordings(written, "r.csv");
  REQUIRE(back.rows() == r.rows());
  CHECK(back.use == r.use);
  for (std::size_t k = 0; k < r.columns.size(); ++k) {
    CHECK(back.columns[k].name == r.columns[k].name);
    CHECK(back.columns[k].unit.text == r.columns[k].unit.text);
    for (std::size_t i = 0; i < r.rows(); ++i) {
      const double a = r.columns[k].values[i], b = back.columns[k].values[i];
      REQUIRE((a == b || (std::isnan(a) && std::isnan(b))));
    }
  }
  CHECK(written.starts_with("pose,a[mm],b[deg],c[K],d[N*mm],use\n0,,"));
}

TEST_CASE("files: missing, a folder, by extension") {
  CHECK_THROWS_WITH_AS(
      read_recordings("no/such.csv"),
      "no/such.csv: there is no such file\n  expected a file of recordings (CSV or TRC)",
      InputError);
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "talus_csv_test";
  std::filesystem::create_directories(folder);
  CHECK_THROWS_AS(read_recordings(folder.string()), InputError);
  const std::string file = (folder / "a.csv").string();
  std::ofstream(file) << "pose,a[mm]\n1,2\n";
  CHECK(read_recordings(file).find("a")->values == std::vector<double>{2});
  CHECK(read_recordings(file).file == file);
  const std::string trc = (folder / "a.TRC").string();
  std::ofstream(trc) << "pose,a[mm]\n1,2\n";
  CHECK_THROWS_AS(read_recordings(trc), InputError);  // no marker file
  std::filesystem::remove_all(folder);
}
