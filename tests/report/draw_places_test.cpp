// What a picture is laid out with: the order of painting, places for names, the bones of a linkage.
#include <doctest/doctest.h>

#include "framework/kinematics/skeleton.h"
#include "framework/report/draw_labels.h"
#include "framework/report/draw_order.h"
#include "tests/support/models.h"

using namespace talus;
using Eigen::Vector2d, Eigen::Vector3d;

TEST_CASE("painter's order: by what lies behind where they overlap, not by their middles") {
  const std::vector<Vector2d> long_floor{{0, 0}, {100, 0}, {100, 10}, {0, 10}},
      post{{0, 2}, {4, 2}, {4, 8}, {0, 8}}, aside{{200, 0}, {210, 0}, {210, 10}};
  // The floor rises from height 0 at x = 0 to 100; the post stands at its low end, 10 above it.
  const Piece floor{long_floor, {1, 0, 0}}, standing{post, {0, 0, 14}}, alone{aside, {0, 0, 0}};
  const std::vector<int> order = painters_order({standing, floor, alone});
  auto at = [&](int piece) { return std::find(order.begin(), order.end(), piece) - order.begin(); };
  REQUIRE(order.size() == 3);
  CHECK(at(1) < at(0));
  // Three that hide each other in a circle are all painted.
  const std::vector<Vector2d> a{{0, 0}, {9, 0}, {9, 2}, {0, 2}}, b{{7, 0}, {9, 0}, {9, 9}, {7, 9}},
      c{{0, 1}, {1, 0}, {9, 8}, {8, 9}};
  CHECK(painters_order({{a, {1, 0, 0}}, {b, {0, 1, 5}}, {c, {-1, -1, 8}}}).size() == 3);
}

TEST_CASE("the overlap of two polygons, and the hull of points") {
  const std::vector<Vector2d> square{{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  const Overlap corner = overlap(square, {{3, 3}, {7, 3}, {7, 7}, {3, 7}});
  CHECK(corner.area == doctest::Approx(1));
  CHECK((corner.middle - Vector2d(3.5, 3.5)).norm() < 1e-12);
  CHECK(overlap(square, {{5, 5}, {6, 5}, {6, 6}}).area == 0);
  CHECK(convex_hull({{0, 0}, {4, 0}, {2, 1}, {4, 4}, {0, 4}, {2, 2}, {2, 0}}).size() == 4);
}

TEST_CASE(
    "names lie neither on each other nor off the page, nor on what is drawn, where there is room") {
  std::vector<LabelWish> wishes;
  for (int i = 0; i < 8; ++i) wishes.push_back({{100 + 5.0 * i, 100}, {60, 12}});
  wishes.push_back({{2, 2}, {60, 12}});
  const LabelBox page{{0, 0}, {400, 300}};
  const std::vector<Obstacle> rod{{{0, 200}, {400, 200}, 3}};
  wishes.push_back({{200, 195}, {60, 12}});
  const auto corners = place_labels(wishes, rod, page);
  std::vector<LabelBox> boxes;
  for (std::size_t i = 0; i < wishes.size(); ++i)
    boxes.push_back({corners[i], corners[i] + wishes[i].size});
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    CAPTURE(i);
    CHECK(boxes[i].low.minCoeff() >= 0);
    CHECK((boxes[i].high.x() <= 400 && boxes[i].high.y() <= 300));
    CHECK((boxes[i].high.y() < 197 || boxes[i].low.y() > 203));
    for (std::size_t j = 0; j < i; ++j) CHECK(boxes[i].overlap(boxes[j]) == 0);
  }
}

TEST_CASE(
    "bones follow Denavit-Hartenberg offsets, and go straight between the centres of hinges") {
  const Program program = testing::program_from(R"(<talus>
    <chain from="A" to="E">
      <dh name="j1" theta="q1" d="30" a="40"/>
      <revolute name="j2" theta="q2" y="5" roll="20"/>
      <storey name="j3" theta="q3" x_fp="-4" z_fp="-9" psi_fp="30" z_td="-7" psi_td="-30"/>
    </chain>
    <encoder name="q1"/><encoder name="q2"/><encoder name="q3"/><point name="E"/></talus>)");
  Posture posture(program);
  posture.set(std::vector<double>{90 * deg, 0, 0});
  Skeleton skeleton(program);
  skeleton.set(posture);
  auto same = [](const Vector3d& p, double x, double y, double z) {
    return (p - Vector3d(x, y, z)).norm() < 1e-9;
  };
  // q1 turns x of A to y: d up by 30, a along y by 40, then 5 along y of that frame.
  CHECK(same(skeleton.centre(1), 0, 0, 0));
  CHECK(same(skeleton.centre(2), -5, 40, 30));
  CHECK(same(skeleton.centre(3), 0, 36, 21));
  const Bone& dh = skeleton.bones()[1];
  REQUIRE(dh.points.size() == 4);
  CHECK(same(dh.points[1], 0, 0, 30));
  CHECK(same(dh.points[2], 0, 40, 30));
  CHECK(same(dh.points[3], -5, 40, 30));
  const Bone& hinge = skeleton.bones()[2];  // not by way of the frame, which lies beside it
  REQUIRE(hinge.points.size() == 2);
  CHECK(same(hinge.points[1], 0, 36, 21));
  CHECK(skeleton.body(0) == 0);
  CHECK(skeleton.moves(3));
  CHECK(skeleton.leaf(3));
  CHECK(same(skeleton.features()[0].translation(), 0, 36, 14));
}
