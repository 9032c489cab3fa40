// Pictures of linkages: where things are in them, what hides what, what is written.
#include "framework/report/draw.h"

#include <tinyxml2.h>

#include <nlohmann/json.hpp>

#include "framework/report/draw_camera.h"
#include "framework/report/draw_canvas.h"
#include "framework/report/draw_film.h"
#include "framework/report/draw_page.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;
using Eigen::Vector2d, Eigen::Vector3d;

namespace {

Picture drawn(const Program& program, const DrawOptions& options = {}) {
  return draw({&program, {{resting_pose(program)}}}, {}, options)[0];
}

std::vector<Mark> of(const Picture& picture, Mark::Kind kind) {
  std::vector<Mark> result;
  for (const Mark& m : picture.marks)
    if (m.kind == kind) result.push_back(m);
  return result;
}

bool shows(const Picture& picture, const std::string& text) {
  for (const Mark& m : of(picture, Mark::Kind::text))
    if (m.text == text) return true;
  return false;
}

// Pixels per mm, as a reader gets them: from the scale's text and the length of its bar.
double scale_of(const Picture& picture) {
  for (std::size_t i = 3; i < picture.marks.size(); ++i) {
    const Mark& m = picture.marks[i];
    if (m.kind != Mark::Kind::text || !m.text.ends_with(" mm") ||
        picture.marks[i - 3].points.size() != 2)
      continue;
    const auto& bar = picture.marks[i - 3].points;
    return (bar[1] - bar[0]).norm() / std::stod(m.text);
  }
  return 0;
}

std::vector<Vector2d> rings(const Picture& picture) {  // of what is measured
  std::vector<Vector2d> result;
  for (const Mark& m : of(picture, Mark::Kind::disc))
    if (m.fill == 0xffffffu && m.stroke) result.push_back(m.points[0]);
  return result;
}

const char* const two_points = R"(<talus name="Two points">
  <chain from="A" to="E"><revolute name="hinge" theta="q"/><mount name="E" x="100" y="40" z="50"/></chain>
  <encoder name="q"/>
  <point name="P" in="A" at="E"/>
  <point name="Q" in="A" at="E" x="30" y="-20" z="10"/></talus>)";

struct Seen {
  const char *view, *up;
  Vector2d right_and_up;  // of the step from P to Q, (30, -20, 10)
};

}  // namespace

TEST_CASE("what is measured is where the view and the scale say") {
  const Program program = program_from(two_points);
  for (const Seen& s : {Seen{"front", "z", {30, 10}},
                        {"side", "z", {-20, 10}},
                        {"top", "z", {30, -20}},
                        {"front", "-z", {30, -10}},
                        {"0, 0", "y", {30, -20}},
                        {"90, 0", "x", {20, 30}}}) {
    CAPTURE(s.view);
    CAPTURE(s.up);
    DrawOptions options;
    options.view = s.view, options.up = s.up;
    const Picture picture = drawn(program, options);
    const auto found = rings(picture);
    REQUIRE(found.size() == 2);
    Vector2d step = (found[1] - found[0]) / scale_of(picture);
    step.y() = -step.y();
    CHECK((step - s.right_and_up).norm() < 1e-9);
  }
}

TEST_CASE("an isometric view shows the three axes equally long, and keeps right hands") {
  const Camera iso = parse_camera("iso", "z");
  for (int i = 0; i < 3; ++i)
    CHECK(iso.rows.col(i).head<2>().norm() == doctest::Approx(std::sqrt(2.0 / 3)));
  for (const char* up : {"x", "y", "z", "-x", "-y", "-z"}) {
    CAPTURE(up);
    const Camera camera = parse_camera("20, 30", up);
    CHECK(camera.rows.determinant() == doctest::Approx(1));
    CHECK((camera.rows * camera.rows.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-12);
    const Vector3d axis = (up[0] == '-' ? -1 : 1) * Vector3d::Unit(std::string(up).back() - 'x');
    CHECK(camera(axis).x() == doctest::Approx(0));
    CHECK(camera(axis).y() > 0);
  }
}

TEST_CASE("the held frame stands still") {
  const Program program = program_from(two_points);
  const Settings swing = grid_settings(program, "q=0:90:30");
  DrawOptions options;
  auto ring = [&](const std::string& hold) {
    options.hold = hold;
    std::vector<Vector2d> result;
    for (const Picture& p : draw({&program, swing}, {}, options)) result.push_back(rings(p)[0]);
    return result;
  };
  const auto root = ring(""), end = ring("E");
  CHECK((root[0] - root[3]).norm() > 50);
  for (const Vector2d& p : end) CHECK((p - end[0]).norm() < 1e-9);
}

TEST_CASE("every shipped model is drawn, with its names, as XML") {
  for (const std::string& file : shipped_models()) {
    CAPTURE(file);
    const Program program = program_of(file);
    DrawOptions options;
    options.frames = {"all"};
    const std::string svg = write_svg(drawn(program, options), program.name);
    tinyxml2::XMLDocument document;
    REQUIRE(document.Parse(svg.c_str()) == tinyxml2::XML_SUCCESS);
    std::string texts;  // names that share a place are one text
    for (auto* e = document.RootElement()->FirstChildElement("text"); e;
         e = e->NextSiblingElement("text"))
      texts += ", " + std::string(e->GetText() ? e->GetText() : "") + ", ";
    CHECK(svg.find("nan") == std::string::npos);
    for (std::size_t f = 0; f < program.frames.size(); ++f) {
      bool named = false;  // by its own name or the one that its chain gives it
      for (const auto& [name, index] : program.frame_index)
        named |= index == static_cast<int>(f) && texts.find(" " + name + ",") != std::string::npos;
      CAPTURE(program.frames[f].name);
      CHECK(named);
    }
  }
}

TEST_CASE("of a cuboid three faces are seen, and the nearer limb hides the farther") {
  const Program program = program_from(R"(<talus>
    <chain from="A" to="B"><mount name="B" y="-50"/></chain>
    <limb name="far" at="A" length="40" width="20" height="30"/>
    <limb name="near" at="B" length="40" width="20" height="30"/>
    <chain from="B" to="C"><revolute name="C" theta="q"/></chain><encoder name="q"/>
    <frame name="C"/></talus>)");
  DrawOptions options;  // the viewer stands at -y, so B is nearer
  const Picture picture = drawn(program, options);
  std::vector<double> middles;
  for (const Mark& m : of(picture, Mark::Kind::polygon))
    if (m.opacity < 1) middles.push_back((m.points[0] + m.points[2]).x() / 2);
  REQUIRE(middles.size() == 6);
  const Camera camera = parse_camera(options.view, options.up);
  const double shift = camera(Vector3d(0, -50, 0)).x() * scale_of(picture);
  const double far = (middles[0] + middles[1] + middles[2]) / 3,
               near = (middles[3] + middles[4] + middles[5]) / 3;
  CHECK(near - far == doctest::Approx(shift));
  CHECK(shows(picture, "far"));
  CHECK(shows(picture, "near"));
  // Limbs stand for the bodies: no rods, whose ends are discs without an edge.
  for (const Mark& m : of(picture, Mark::Kind::disc)) CHECK((m.stroke || m.size < 4));
}

TEST_CASE("a ghost has its own names, the values of the coordinates that it shares, its colour") {
  const Program program = program_from(two_points);
  const Program other = program_from(R"(<talus name="Other">
    <chain from="A" to="tip"><dh name="j" theta="r" a="80"/><dh name="k" theta="s" a="60"/></chain>
    <encoder name="r" column="q"/><encoder name="s" range="20, 40"/><point name="tip"/></talus>)");
  const Settings pose{{{0.5}}};
  const Settings theirs = same_poses(program, pose, other, {});
  CHECK(theirs.poses == std::vector<std::vector<double>>{{0.5, 30 * deg}});
  const Picture picture = draw({&program, pose}, {{&other, theirs}}, {})[0];
  CHECK(shows(picture, "tip"));
  CHECK(shows(picture, "Other"));
  CHECK(shows(picture, "E"));
  const auto lines = of(picture, Mark::Kind::line);
  CHECK(std::count_if(lines.begin(), lines.end(),
                      [](const Mark& m) { return m.stroke == 0xaa3377u; }) >= 4);
}

TEST_CASE("poses: at rest, in between, of a stranger") {
  const Program program = program_from(R"(<talus>
    <chain from="A" to="E"><dh name="j" theta="q" a="80"/><prismatic name="s" d="r"/></chain>
    <encoder name="q"/><linear name="r" range="10, 30"/><point name="E"/></talus>)");
  CHECK(resting_pose(program) == std::vector<double>{0, 20});
  const Settings between = interpolated(program, {{{170 * deg, 10}, {-170 * deg, 30}}},
                                        3);  // the shorter way: by 20 deg
  REQUIRE(between.poses.size() == 5);
  CHECK(between.poses[2][0] == doctest::Approx(180 * deg));
  CHECK(between.poses[2][1] == doctest::Approx(20));
  CHECK(between.poses[4][0] == -170 * deg);
  const Program stranger = program_from(two_points);
  std::string complaint;
  try {
    same_poses(stranger, {{{0}}}, program_from(R"(<talus><chain from="A" to="E">
      <dh name="j" theta="elbow"/></chain><encoder name="elbow"/><point name="E"/></talus>)"),
               {"other.xml", 0, 0});
  } catch (const InputError& e) {
    complaint = e.what();
  }
  CHECK(complaint ==
        "other.xml: its coordinates are elbow\n  expected one or more of those of the model: q");
}

TEST_CASE("a film holds every picture, what they share once, and refers to nothing outside") {
  const Program program = program_of(shipped("isl-bonny-2013/published.xml"));
  const Settings settings = random_settings(program, 60, 1);
  Film film{.title = "</script> & co"};
  film.pictures = draw({&program, settings}, {}, {});
  for (int k = 1; k <= 60; ++k) film.titles.push_back("row " + std::to_string(k));
  const std::string html = write_film_html(film);
  CHECK(html.size() < 2000000);
  const std::string begin = "<script type=\"application/json\" id=\"film\">";
  const std::size_t from = html.find(begin) + begin.size();
  const auto data = nlohmann::json::parse(html.substr(from, html.find("</script>", from) - from));
  REQUIRE(data["frames"].size() == 60);
  CHECK(data["titles"].size() == 60);
  std::size_t used = 0;
  for (std::size_t k = 0; k < 60; ++k) {
    CHECK(data["frames"][k].size() == film.pictures[k].marks.size());
    used += data["frames"][k].size();
  }
  CHECK(data["elements"].size() < used);
  std::size_t links = 0;
  for (std::size_t at = 0; (at = html.find("://", at)) != std::string::npos; ++at) ++links;
  CHECK(links == 1);  // the name space of SVG
  tinyxml2::XMLDocument moving;
  REQUIRE(moving.Parse(write_film_svg(film).c_str()) == tinyxml2::XML_SUCCESS);
  int groups = 0;
  for (auto* g = moving.RootElement()->FirstChildElement("g"); g; g = g->NextSiblingElement("g")) {
    ++groups;
    CHECK(g->FirstChildElement("animate") != nullptr);
  }
  CHECK(groups == 60);
}

TEST_CASE("one picture in every form, twice the same") {
  const Program program = program_from(two_points);
  DrawOptions options;
  options.width = 400, options.height = 300;
  const Picture picture = drawn(program, options);
  CHECK(write_png(picture).starts_with("\x89PNG"));
  CHECK(write_pdf(picture, "two").starts_with("%PDF"));
  CHECK(write_pdf(picture, "two") == write_pdf(drawn(program, options), "two"));
  const std::string pixels = raw_pixels(picture);
  CHECK(pixels.size() == 4 * 400 * 300);
  CHECK(static_cast<unsigned char>(pixels[0]) == 255);  // paper
}

TEST_CASE("views and frames that there are not") {
  const Program program = program_from(two_points);
  auto complaint = [&](auto change) {
    DrawOptions options;
    change(options);
    try {
      drawn(program, options);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("nothing to complain about");
  };
  CHECK(complaint([](DrawOptions& o) { o.view = "fornt"; }) ==
        "--view fornt: no such view\n  expected front, side, top, iso, or \"azimuth, elevation\"\n"
        "  did you mean 'front'?");
  CHECK(complaint([](DrawOptions& o) { o.view = "10, 100"; }) ==
        "--view 10, 100: no such elevation\n  expected -90 to 90 deg");
  CHECK(complaint([](DrawOptions& o) { o.up = "w"; }) ==
        "--up w: no such axis\n  expected x, y, z, -x, -y or -z");
  CHECK(complaint([](DrawOptions& o) { o.frames = {"hing"}; }) ==
        "--frames hing: no frame 'hing'\n  expected one of: A, E, hinge\n  did you mean 'hinge'?");
  CHECK(complaint([](DrawOptions& o) { o.hold = "B"; }) ==
        "--hold B: no frame 'B'\n  expected one of: A, E, hinge\n  did you mean 'A'?");
}
