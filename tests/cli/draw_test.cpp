// talus draw as users run it.
#include <nlohmann/json.hpp>

#include "framework/report/draw_video.h"
#include "tests/support/command.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

namespace {

const std::string isl = "draw '" + shipped("isl-bonny-2013/published.xml") + "' ",
                  isl_table = "'" + shipped("isl-bonny-2013/recordings.csv") + "' ";

std::string complaint(const Folder& folder, const std::string& arguments) {
  const Run run = command(folder, arguments);
  CHECK(run.code == 2);
  CHECK(run.out.empty());
  return said(run.error);
}

}  // namespace

TEST_CASE("a picture of every sort, named or after the model") {
  const Folder folder;
  const Run run = command(folder, isl + "--out pictures");
  CHECK(run.code == 0);
  CHECK(run.out == "Picture: pictures/published.svg\n");
  CHECK(contents(folder / "pictures/published.svg").starts_with("<?xml"));
  CHECK(command(folder, isl + isl_table + "--pose 65 --picture p.png --size 400x300").code == 0);
  CHECK(contents(folder / "p.png").starts_with("\x89PNG"));
  CHECK(command(folder, isl + "--grid 'encoder1=0:90:30' --pose 4 --picture p.pdf --quiet").out ==
        "");
  CHECK(contents(folder / "p.pdf").starts_with("%PDF"));
  CHECK(command(folder, isl + isl_table + "--pose 3 --picture - ").code == 2);
  CHECK(command(folder, isl + isl_table + "--pose 3 --picture three.svg").code == 0);
  CHECK(contents(folder / "three.svg").find("row 3: encoder1 -68.5 deg") != std::string::npos);
}

TEST_CASE(
    "an animation of all rows, with pictures in between, and without row 2, which is not whole") {
  const Folder folder;
  folder.write("arm.xml",
               R"(<talus name="arm"><chain from="A" to="E"><dh name="j" theta="q" a="80"/>
    <dh name="k" theta="u" a="60"/></chain><encoder name="q"/><unknown name="u" kind="angle" value="10"/>
    <frame name="E"/></talus>)");
  folder.write("table.csv", "q[deg]\n0\n\n20\n30\n");
  folder.write("holes.csv", "pose,q[deg]\n1,0\n2,\n3,20\n4,30\n");
  const Run run = command(folder, "draw arm.xml holes.csv --between 4 --animation arm.html");
  CHECK(run.code == 0);
  CHECK(run.out == "Animation: arm.html (11 pictures)\n");
  CHECK(run.error == "Warning: holes.csv has no column u: there the model's start is shown.\n");
  const std::string html = contents(folder / "arm.html");
  CHECK(html.find("row 1 to 3") != std::string::npos);
  CHECK(html.find("q 5.0 deg, u 10.0 deg") == std::string::npos);
  CHECK(html.find("row 1 to 3: q 4.0 deg, u 10.0 deg") != std::string::npos);
  CHECK(folder.files().size() == 4);  // no picture beside it
  CHECK(complaint(folder, "draw arm.xml holes.csv --pose 2 --quiet") ==
        "Warning: holes.csv has no column u: there the model's start is shown.\n"
        "holes.csv:3: this row lacks a reading\n  expected another --pose\n");
  CHECK(complaint(folder, "draw arm.xml holes.csv --pose 5") ==
        "--pose 5: there are 4 rows\n  expected 1 to 4\n");
  CHECK(folder.files().size() == 4);
}

TEST_CASE("what cannot be drawn is said, and nothing is written") {
  const Folder folder;
  CHECK(complaint(folder, isl + "--picture p.jpg") ==
        "p.jpg: unknown ending\n  expected one of: .svg, .png, .pdf\n");
  CHECK(complaint(folder, isl + "--animation p.htm") ==
        "p.htm: unknown ending\n  expected one of: .html, .svg, .gif, .mp4, .webm\n"
        "  did you mean '.html'?\n");
  CHECK(complaint(folder, isl + "--picture nowhere/p.svg") ==
        "nowhere/p.svg: cannot be written: there is no folder 'nowhere'\n");
  CHECK(complaint(folder, isl + "--size 10x10") ==
        "--size 10x10: no such size\n  expected WIDTHxHEIGHT in pixels, each 100 to 20000: "
        "1000x750\n");
  CHECK(complaint(folder, isl + isl_table + "--grid encoder1=0") ==
        "talus draw: recordings, --poses and --grid exclude each other\n  expected one of them\n");
  const std::string device = shipped("device-nordquist-2009/model.xml");
  CHECK(complaint(folder, isl + "--ghost '" + device + "'") ==
        device +
            ": its coordinates are micrometer1, micrometer2, micrometer3\n"
            "  expected one or more of those of the model: encoder1, encoder2, encoder3, encoder4, "
            "encoder5, encoder6\n");
  const std::string far = complaint(folder, "draw '" + device + "' --grid micrometer1=300 --out o");
  CHECK(far.find(" has no place at micrometer1 300.0 mm, ") != std::string::npos);
  CHECK(complaint(folder, isl + "--animation a.html --poses 9 --between 999") ==
        "a.html: 8001 pictures\n  expected at most 5000: fewer rows or a smaller --between\n");
  CHECK(folder.files().empty());
}

TEST_CASE("videos are made by ffmpeg, and nothing is left where there is none") {
  const Folder folder;
  const std::string line = "cd '" + folder.path().string() +
                           "' && PATH=/nowhere '" TALUS_COMMAND "' " + isl +
                           "--poses 3 --animation a.mp4";
  CHECK(shell(line) == 1);
  CHECK(folder.files().empty());
  if (!ffmpeg_found()) {
    MESSAGE("ffmpeg is not installed: videos are not made");
    return;
  }
  for (const char* ending : {"gif", "mp4", "webm"}) {
    CAPTURE(ending);
    const Run run = command(folder, isl + "--poses 3 --size 201x151 --animation a." + ending);
    CAPTURE(run.error);
    CHECK(run.code == 0);
    CHECK(contents(folder / (std::string("a.") + ending)).size() > 500);
  }
  CHECK(folder.files().size() == 3);
}
