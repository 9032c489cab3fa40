// Plugins against formulas written out independently: each joint as its matrix or as a product of
// plain 4x4 matrices, sensors, features and residuals at places worked out by hand.
#include <doctest/doctest.h>

#include <numbers>

#include "tests/support/plain.h"

namespace talus {
namespace {

using namespace testing;
using doctest::Approx;
using std::cos, std::sin;
constexpr double pi = std::numbers::pi;

void check_near(const std::vector<double>& found, const std::vector<double>& expected,
                double tolerance = 1e-12) {
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    CAPTURE(i);
    CAPTURE(found[i]);
    CAPTURE(expected[i]);
    CHECK(std::abs(found[i] - expected[i]) <= tolerance);
  }
}

Observed<Expr> seen_frame(const Matrix4& m) { return {.kind = Kind::frame, .frame = rigid(m)}; }

}  // namespace

TEST_CASE("Denavit-Hartenberg joints are the matrices of the papers") {
  const double q = 0.7, d = 30, a = 50, al = -0.4, be = 0.2;
  const double c = cos(q), s = sin(q), ca = cos(al), sa = sin(al);
  const Matrix4 distal{
      {{c, -s * ca, s * sa, a * c}, {s, c * ca, -c * sa, a * s}, {0, sa, ca, d}, {0, 0, 0, 1}}};
  const Matrix4 proximal{
      {{c, -s, 0, a}, {s * ca, c * ca, -sa, -sa * d}, {s * sa, c * sa, ca, ca * d}, {0, 0, 0, 1}}};
  CHECK(farthest(run_joint("dh", {q, d, a, al}), distal) < 1e-14);
  CHECK(farthest(run_joint("dh_proximal", {q, d, a, al}), proximal) < 1e-14);
  CHECK(farthest(run_joint("dh_hayati", {q, d, a, al, be}), distal * rot_y(be)) < 1e-14);
}

TEST_CASE("hinges, slide and screw about an axis by two angles") {
  const double q = 0.8, x = 10, y = -20, z = 5, roll = -0.5, yaw = 0.3, pitch = 4;
  const double u[] = {sin(yaw), -sin(roll) * cos(yaw), cos(roll) * cos(yaw)};  // Rx(roll) Ry(yaw) z
  const Matrix4 hinge = trans(x, y, z) * rot_x(roll) * rot_y(yaw) * rot_z(q) * rot_y(-yaw) *
                        rot_x(-roll) * trans(-x, -y, -z);
  CHECK(farthest(run_joint("revolute", {q, x, y, z, roll, yaw}), hinge) < 1e-13);
  CHECK(farthest(run_joint("revolute_about", {q, x, y, z, 7 * u[0], 7 * u[1], 7 * u[2]}), hinge) <
        1e-13);
  CHECK(farthest(run_joint("prismatic", {12, roll, yaw}), trans(12 * u[0], 12 * u[1], 12 * u[2])) <
        1e-13);
  const double way = pitch * q;
  CHECK(farthest(run_joint("screw", {q, pitch, x, y, z, roll, yaw}),
                 trans(way * u[0], way * u[1], way * u[2]) * hinge) < 1e-13);
}

TEST_CASE("placements in the three orders") {
  const double a = 0.3, b = -1.1, c = 2.0;
  for (const char* tag : {"mount", "fixed"}) {
    CHECK(farthest(run_joint(tag, {1, 2, 3, a, b, c}, {0}),
                   trans(1, 2, 3) * rot_z(a) * rot_x(b) * rot_z(c)) < 1e-15);
    CHECK(farthest(run_joint(tag, {1, 2, 3, a, b, c}, {1}),
                   trans(1, 2, 3) * rot_z(c) * rot_y(b) * rot_x(a)) < 1e-15);
    CHECK(farthest(run_joint(tag, {1, 2, 3, 0, 0, c}, {2}), trans(1, 2, 3) * rot_z(c)) < 1e-15);
    CHECK(farthest(run_joint(tag, {1, 2, 3, 0, 0, 0}, {2}), trans(1, 2, 3)) == 0);
    // A third of a turn about the diagonal moves each axis to the next.
    const double third = 2 * pi / 3 / std::sqrt(3.0);
    const Matrix4 next{{{0, 0, 1, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}}};
    CHECK(farthest(run_joint(tag, {0, 0, 0, third, third, third}, {2}), next) < 1e-15);
  }
}

TEST_CASE("ball joint and the hinge of non-orthogonal limbs") {
  CHECK(farthest(run_joint("spherical", {0.1, 0.2, 0.3, 4, 5, 6}),
                 trans(4, 5, 6) * rot_z(0.3) * rot_y(0.2) * rot_x(0.1) * trans(-4, -5, -6)) <
        1e-14);
  const Matrix4 limbs = trans(1, 2, 3) * rot_x(0.1) * rot_y(0.2) * rot_z(0.3) * rot_z(0.9) *
                        rot_z(-0.4) * rot_y(-0.5) * rot_x(-0.6) * trans(7, 8, 9);
  CHECK(farthest(run_joint("storey", {0.9, 1, 2, 3, 0.1, 0.2, 0.3, -0.4, -0.5, -0.6, 7, 8, 9}),
                 limbs) < 1e-13);
  // Offsets to the distal limb that undo those from the proximal limb: the plain hinge (Storey's
  // table 1: joint 2 has phi 20, psi 15 deg, turned by 30 deg).
  const double phi = 20 * deg, psi = 15 * deg, q = 30 * deg;
  CHECK(farthest(run_joint("storey", {q, 5, 6, 7, psi, phi, 0, 0, -phi, -psi, -5, -6, -7}),
                 run_joint("revolute", {q, 5, 6, 7, psi, phi})) < 1e-13);
}

TEST_CASE("sensors") {
  CHECK(run_sensor("encoder", 2, {1.01, 0.5}) == Approx(2.52).epsilon(1e-15));
  CHECK(run_sensor("linear", 20, {0.5, -3}) == Approx(7).epsilon(1e-15));
  CHECK(run_sensor("covariate", 1.25, {}) == 1.25);
  // A 3-4-5 triangle has its right angle opposite the longest side.
  CHECK(run_sensor("micrometer_triangle", 3, {3, 4, 2, 0.1}, {0}) ==
        Approx(pi / 2 + 0.1).epsilon(1e-15));
  CHECK(run_sensor("micrometer_triangle", 3, {3, 4, 2, 0.1}, {1}) ==
        Approx(-pi / 2 + 0.1).epsilon(1e-15));
  // The calibration device's neutral position: joint 1 at 0 with the third side 25.40 mm, joint 2
  // at 90 deg with 30.48 mm (Nordquist and Hull 2009, table 2).
  CHECK(std::abs(run_sensor("micrometer_triangle", 17.6, {42.597, 38.6255, 7.8, -36.0276 * deg},
                            {0})) < 0.01 * deg);
  CHECK(std::abs(run_sensor("micrometer_triangle", 17.6, {42.597, 38.6255, 7.8, 36.0276 * deg},
                            {1})) < 0.01 * deg);
  CHECK(
      std::abs(run_sensor("micrometer_triangle", 20.75, {44.012, 31.75, 9.73, 46.1689 * deg}, {0}) -
               90 * deg) < 0.1 * deg);
  CHECK(std::isnan(run_sensor("micrometer_triangle", 100, {3, 4, 0, 0}, {0})));
}

TEST_CASE("features read their columns") {
  // cos 45, sin 45 about z: a quarter turn; sign and length of the quaternion are of no matter.
  for (double k : {1.0, -1.0, 3.0})
    CHECK(farthest(plain(run_feature("frame", {1, 2, 3, k, 0, 0, k}).frame),
                   trans(1, 2, 3) * rot_z(pi / 2)) < 1e-15);
  CHECK(farthest(plain(run_feature("point", {1, 2, 3}).frame), trans(1, 2, 3)) == 0);
  const auto direction = run_feature("direction", {0, 3, 4});
  CHECK(direction.vector[1].constant() == Approx(0.6).epsilon(1e-15));
  CHECK(direction.vector[2].constant() == Approx(0.8).epsilon(1e-15));
  CHECK_FALSE(direction.angles);
  const auto angles = run_feature("direction_angles", {1.5, 1.4, 0.2});
  CHECK(angles.angles);
  CHECK(angles.vector[1].constant() == 1.4);
  CHECK(run_feature("length", {240.3}).scalar.constant() == 240.3);
  CHECK(run_feature("closure", {}).kind == Kind::nothing);
  // Where they sit on the frame `at`.
  const auto at = [](const char* tag, const std::vector<double>& inputs) {
    return plain(plugin(tag, Family::feature).transform(constants(inputs), {}));
  };
  CHECK(farthest(at("point", {1, 2, 3}), trans(1, 2, 3)) == 0);
  CHECK(farthest(at("length", {1, 2, 3}), trans(1, 2, 3)) == 0);
  for (const char* tag : {"direction", "direction_angles"})
    CHECK(farthest(at(tag, {0.2, 0.3}), rot_x(0.2) * rot_y(0.3)) < 1e-15);
}

TEST_CASE("residuals of position") {
  const Matrix4 model = trans(10, 20, 30) * rot_z(pi / 2);
  const Matrix4 seen = trans(11, 22, 33);
  // The frame's error is seen from the modelled frame: x there is y of `in`.
  check_near(run_residual("position", model, seen_frame(seen)), {2, -1, 3});
  check_near(run_residual("position", model, run_feature("point", {11, 22, 33})), {1, 2, 3});
  check_near(run_residual("position", model, run_feature("closure", {})), {-10, -20, -30});
  const Matrix4 far = trans(3, 4, 12);  // 13 from the origin
  check_near(run_residual("vector_length", far, run_feature("length", {13.5})), {0.5});
  check_near(run_residual("vector_length", far, run_feature("point", {0, 3, 4})), {-8});
  check_near(run_residual("vector_length", trans(0, 0, 0), seen_frame(far)), {13});
  check_near(run_residual("distance", far, run_feature("closure", {}), {20}), {7});
  check_near(run_residual("distance", far, run_feature("length", {14}), {20}), {1});
  check_near(run_residual("distance", far, seen_frame(trans(0, 3, 4)), {20}), {-8});
  const auto points = run_residual("frame_points", trans(0, 0, 0),
                                   seen_frame(trans(1, 2, 3) * rot_z(pi / 2)), {100});
  check_near(points, {1, 2, 3, -99, 102, 3, -99, -98, 3, 1, 2, 3});
}

TEST_CASE("residuals of orientation") {
  const Matrix4 model = trans(1, 2, 3) * rot_x(0.4) * rot_z(-1.2);
  const auto error = [&](const char* tag, const Matrix4& E) {
    return run_residual(tag, model, seen_frame(model * E));
  };
  for (const char* tag : {"rotation_vector", "projection_angles"}) {
    check_near(error(tag, rot_x(0.3)), {0.3, 0, 0});
    check_near(error(tag, rot_y(-1.5)), {0, -1.5, 0});
    check_near(error(tag, rot_z(1e-5)), {0, 0, 1e-5}, 1e-15);
    check_near(error(tag, trans(0, 0, 0)), {0, 0, 0}, 1e-15);
    const auto loop = run_residual(tag, rot_z(0.2), run_feature("closure", {}));
    check_near(loop, {0, 0, -0.2});
  }
  check_near(error("rotation_vector", rot_y(-3)), {0, -3, 0});
  const Matrix4 E = rot_x(0.2) * rot_y(0.1) * rot_z(2);
  check_near(
      error("projection_angles", E),
      {std::atan2(E[2][1], E[1][1]), std::atan2(E[0][2], E[2][2]), std::atan2(E[1][0], E[0][0])});
}

TEST_CASE("residuals of a direction") {
  // Modelled z axis tilted by 0.1 about x: angles 90, 90 + and 0.1 to x, y, z.
  const Matrix4 model = rot_x(0.1);
  check_near(run_residual("inverse_direction_cosines", model,
                          run_feature("direction_angles", {1.6, 1.7, 0.15})),
             {1.6 - pi / 2, 1.7 - (pi / 2 + 0.1), 0.05});
  check_near(run_residual("inverse_direction_cosines", model, run_feature("direction", {0, 0, 2})),
             {0, -0.1, -0.1});
  check_near(run_residual("inverse_direction_cosines", model, seen_frame(rot_z(1) * rot_x(0.1))),
             {std::acos(std::sin(1.0) * std::sin(0.1)) - pi / 2,
              std::acos(-std::cos(1.0) * std::sin(0.1)) - (pi / 2 + 0.1), 0},
             1e-9);
  check_near(run_residual("direction", model, run_feature("direction", {0, -sin(0.3), cos(0.3)})),
             {0, -0.2});
  check_near(run_residual("direction", model,
                          run_feature("direction_angles", {pi / 2 - 0.2, pi / 2, 0.2})),
             {std::atan2(sin(0.2), cos(0.2) * cos(0.1)), 0.1});
}

TEST_CASE("derivatives stay finite where an axis is aligned or a length vanishes") {
  Tape tape;
  Matrix3<Expr> R;
  Vector3<Expr> p;
  std::vector<double> identity;
  for (int i = 0; i < 12; ++i) {
    (i < 9 ? R[i / 3][i % 3] : p[i - 9]) = Expr::leaf(tape, i);
    identity.push_back(i < 9 && i % 4 == 0 ? 1 : 0);
  }
  const Rigid<Expr> model(R, p);
  for (const Plugin* residual : Registry::built_in().all()) {
    if (residual->declaration.family != Family::residual) continue;
    CAPTURE(residual->declaration.tag);
    for (Kind kind : residual->declaration.kinds) {
      const Observed<Expr> measured{.kind = kind, .vector = {Expr(0), Expr(0), Expr(1)}};
      std::vector<Expr> inputs;
      for (const Input& input : residual->declaration.inputs) inputs.push_back(input.otherwise);
      for (const Expr& row : residual->rows(model, measured, inputs, {}))
        for (const auto& [slot, g] : gradient(row))
          CHECK(std::isfinite(g.is_constant() ? g.constant() : tape.evaluate(g.node(), identity)));
    }
  }
}

TEST_CASE("the gap of a loop") {
  check_near(run_residual("closure", trans(1, 2, 3) * rot_y(0.2), run_feature("closure", {})),
             {-1, -2, -3, 0, -0.2, 0});
}

// The printed table of the calibration device; at beta = (0, 90, 0) deg both ends are parallel and
// the moving origin is at (-101.60, -238.73, 0) mm of the fixed frame.
TEST_CASE("the calibration device of Nordquist and Hull 2009 in its neutral position") {
  const double beta[] = {0, 90 * deg, 0}, d[] = {-238.7346, 0, 101.6};
  Matrix4 f_in_m = run_joint("dh_proximal", {0, -35.56, 0, 0});
  for (int i = 0; i < 3; ++i)
    f_in_m = f_in_m * run_joint("dh_proximal", {beta[i], d[i], 0, 90 * deg});
  f_in_m = f_in_m * run_joint("dh_proximal", {90 * deg, 35.56, 0, 90 * deg});
  const Matrix4 m_in_f = plain(inverse(rigid(f_in_m)));
  CHECK(farthest(m_in_f, trans(-101.60, -238.7346, 0)) < 1e-12);
}

}  // namespace talus
