// Storey et al. 2006, sec. V: yaw, pitch and roll of limbs, by back calculation from the vertices
// and from the rotation matrices alone; and where the published equations fail.
#include <array>
#include <cmath>
#include <limits>

#include "framework/kinematics/angles.h"
#include "tests/support/storey.h"

using namespace talus;
using namespace talus::testing;
using namespace talus::testing::storey;

namespace {

// The limb's rotation, from its columns: those of the local axes (10 to 12) less the centre (9).
Matrix3d rotation_from(const MatrixXd& V, int limb) {
  Matrix3d R;
  for (int i = 0; i < 3; ++i)
    R.col(i) = (V.block<3, 1>(0, 12 * limb + 9 + i) - V.block<3, 1>(0, 12 * limb + 8)).normalized();
  return R;
}

const AxisSequence roll_pitch_yaw = parse_axis_sequence("xzy", {});  // of eq. 19

// Back calculation as in sec. V (roll, then pitch, then yaw, each undone before the next), with arc
// tangents of two arguments.
std::array<double, 3> back_calculated(const Matrix3d& axes) {
  const Vector3d y = axes.col(1);
  const double roll = std::atan2(y.z(), y.y());
  const Matrix3d unrolled = roll_x(-roll).topLeftCorner<3, 3>() * axes;
  const double pitch = std::atan2(-unrolled(0, 1), unrolled(1, 1));
  const Matrix3d unpitched = pitch_z(-pitch).topLeftCorner<3, 3>() * unrolled;
  return {roll, pitch, std::atan2(-unpitched(2, 0), unpitched(0, 0))};
}

double apart(double a, double b) { return std::abs(std::remainder(a - b, 360 * deg)); }

// The sign rule of eqs 12, 14, 18, 21 and 22, z / |z|: nothing at zero.
double sign_rule(double z) {
  return std::abs(z) < 1e-12 ? std::numeric_limits<double>::quiet_NaN() : z / std::abs(z);
}
double arc_cosine(double x) { return std::acos(std::clamp(x, -1.0, 1.0)); }

using Angles = std::array<double, 3>;  // roll psi, pitch theta, yaw phi

// The limb's local axes turned back by roll and pitch, as sec. V goes on to do (eqs 15 and 16).
Matrix3d turned_back(const Matrix3d& axes, double roll, double pitch) {
  return (pitch_z(pitch) * roll_x(roll)).topLeftCorner<3, 3>() * axes;
}
// Eqs 8 to 18. In eq. 13 the second and the third component must be swapped: u'' is in the
// xy-plane.
Angles published_from_vertices(const Matrix3d& axes) {
  const Vector3d y = axes.col(1);
  const double u = std::hypot(y.y(), y.z());
  const double roll = -arc_cosine(y.y() / u) * sign_rule(y.z());
  const double pitch = arc_cosine(u / std::hypot(u, y.x())) * sign_rule(y.x());
  const Vector3d x = turned_back(axes, roll, pitch).col(0);
  return {roll, pitch, arc_cosine(x.x() / std::hypot(x.x(), x.z())) * sign_rule(x.z())};
}
// Eqs 20 to 22, z_dc of roll and yaw given.
Angles published_from_matrix(const Matrix3d& RM, double z_roll, double z_yaw) {
  const double pitch = std::asin(std::clamp(RM(0, 1), -1.0, 1.0));
  return {-arc_cosine(RM(1, 1) / std::cos(pitch)) * sign_rule(z_roll), pitch,
          arc_cosine(RM(0, 0) / std::cos(pitch)) * sign_rule(z_yaw)};
}
// Eq. 6, with cos(psi) for cos(theta) in its third diagonal entry.
Matrix3d equation_6(const Angles& a) {
  const double cr = std::cos(a[0]), sr = std::sin(a[0]), cp = std::cos(a[1]), sp = std::sin(a[1]),
               cy = std::cos(a[2]), sy = std::sin(a[2]);
  Matrix3d R;
  R << cy * cp, sp, -cp * sy,                                    //
      -cr * sp * cy + sr * sy, cr * cp, cr * sy * sp + sr * cy,  //
      cy * sp * sr + sy * cr, -cp * sr, -sr * sy * sp + cr * cy;
  return R;
}
// Eq. 19 with eqs 3 to 5.
Matrix3d equation_19(const Angles& a) {
  return (roll_x(a[0]) * pitch_z(a[1]) * yaw_y(a[2])).topLeftCorner<3, 3>();
}
bool same_rotation(const Matrix3d& a, const Matrix3d& b) {
  return (a - b).cwiseAbs().maxCoeff() < 1e-7;  // false for NaN
}

// Joint angles from -180 to 180 deg for which something fails, as first and last of each stretch.
using Stretches = std::vector<std::pair<int, int>>;
struct Failures {
  Stretches where;
  int count = 0;
  void at(int q) {
    ++count;
    if (where.empty() || where.back().second != q - 1) where.emplace_back(q, q);
    where.back().second = q;
  }
};

}  // namespace

TEST_CASE("yaw, pitch and roll from the vertices and from the rotation matrices alone agree") {
  const Device device;
  int compared = 0;
  for (double other : {0.0, 70.0})  // of the joint that is not swept
    for (int joint = 0; joint < 2; ++joint)
      for (int q = -180; q <= 180; ++q) {
        Vertices system(device.joints, device.limbs);
        system.rotate(1 - joint, other * deg);
        system.rotate(joint, q * deg);
        // The paper's [RM_#]: the build's rotations, without translations. That of limb 2 must be
        // multiplied with that of limb 1, which the printed list leaves out.
        Matrix3d RM = Matrix3d::Identity();
        for (int j = 0; j <= joint; ++j) RM *= system.joints[j].whole().topLeftCorner<3, 3>();
        const Matrix3d from_vertices = rotation_from(system.V, joint + 1);
        const auto a = back_calculated(from_vertices), b = angles_of(RM, roll_pitch_yaw);
        CHECK(farthest(rotation_of(a, roll_pitch_yaw), rotation_of(b, roll_pitch_yaw)) < 1e-13);
        CHECK(farthest(rotation_of(a, roll_pitch_yaw), from_vertices) < 1e-13);
        REQUIRE(std::abs(std::cos(b[1])) > 0.01);  // away from the singular point, all along
        for (int n = 0; n < 3; ++n) CHECK(apart(a[n], b[n]) < 1e-12);
        compared += other == 0;
        if (joint == 1 && other != 0)
          CHECK(farthest(system.joints[1].whole().topLeftCorner<3, 3>(), from_vertices) > 0.1);
      }
  CHECK(compared == 722);
}

TEST_CASE("eq. 6 is the inverse of yaw, pitch, roll in order, and has one entry misprinted") {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Angles a{between(random, -3, 3), between(random, -3, 3), between(random, -3, 3)};
    const Matrix3d forward = (yaw_y(a[2]) * pitch_z(a[1]) * roll_x(a[0])).topLeftCorner<3, 3>();
    CHECK(farthest(equation_6(a), forward.transpose()) < 1e-14);
    // So it is eq. 19 with all three angles the other way round.
    CHECK(farthest(equation_6(a), equation_19({-a[0], -a[1], -a[2]})) < 1e-14);
    Matrix3d printed = equation_6(a);
    printed(2, 2) += std::cos(a[2]) * (std::cos(a[1]) - std::cos(a[0]));
    CHECK(farthest(printed * printed.transpose(), Matrix3d::Identity()) > 1e-4);
  }
}

TEST_CASE("where the published angles fail, of 722 positions") {
  const Device device;
  Failures vertices[2], matrix[2], literal[2], one_sign[2], in_19[2];
  for (int joint = 0; joint < 2; ++joint)
    for (int q = -180; q <= 180; ++q) {
      Vertices system(device.joints, device.limbs);
      system.rotate(joint, q * deg);
      const Matrix3d R = rotation_from(system.V, joint + 1);
      const Angles a = published_from_vertices(R);
      if (!same_rotation(equation_6(a), R)) vertices[joint].at(q);
      if (!same_rotation(equation_19(a), R)) in_19[joint].at(q);
      // z_dc of eq. 21 is that of eq. 10; z_dc of eq. 22 that of eq. 16, (a) turned back by roll
      // and pitch as in sec. V, (b) as the equation stands, (c) if it were that of eq. 10 too.
      const Angles b = published_from_matrix(R, R(2, 1), 1);
      auto fails = [&](double z_yaw) {
        return !same_rotation(equation_6(published_from_matrix(R, R(2, 1), z_yaw)), R);
      };
      if (fails(turned_back(R, b[0], b[1])(2, 0))) matrix[joint].at(q);
      if (fails(R(2, 0))) literal[joint].at(q);
      if (fails(R(2, 1))) one_sign[joint].at(q);
    }
  for (int joint = 0; joint < 2; ++joint) {
    CAPTURE(joint);
    // Eqs 12, 14, 18, and 21, 22 read so that they work: the sign rule is undefined at the neutral
    // position, in both joints: 2 of 722. MATLAB makes NaN of it.
    CHECK(vertices[joint].where == Stretches{{0, 0}});
    CHECK(matrix[joint].where == Stretches{{0, 0}});
    // Eq. 22 with the sign of eq. 16 as it stands: 464 of 722. With one sign for both: 115.
    CHECK(literal[joint].where == (joint == 0 ? Stretches{{-180, -54}, {0, 0}, {54, 180}}
                                              : Stretches{{-180, -77}, {0, 0}, {77, 180}}));
    CHECK(one_sign[joint].where ==
          (joint == 0 ? Stretches{{0, 0}, {54, 128}} : Stretches{{0, 0}, {77, 114}}));
    // Eq. 19 with eqs 3 to 5 never puts the limb back: the angles are those that turn it to the
    // global axes, eq. 19 wants their opposites.
    CHECK(in_19[joint].where == Stretches{{-180, 180}});
  }
  CHECK(vertices[0].count + vertices[1].count == 2);
  CHECK(literal[0].count + literal[1].count == 464);
  CHECK(one_sign[0].count + one_sign[1].count == 115);
}

TEST_CASE("eq. 20: the pitch stays within 90 deg because the other two jump, and at 90 they fail") {
  const Device device;
  for (int joint = 0; joint < 2; ++joint) {
    double most = 0;
    for (int q = -180; q <= 180; ++q) {
      Vertices system(device.joints, device.limbs);
      system.rotate(joint, q * deg);
      const Matrix3d R = rotation_from(system.V, joint + 1);
      const double pitch = angles_of(R, roll_pitch_yaw)[1];
      most = std::max(most, std::abs(pitch) / deg);
      // Published: asin(RM(1,2)), the other way round as all of them.
      CHECK(std::abs(published_from_matrix(R, 1, 1)[1] + pitch) < 1e-12);
    }
    // As far as the axes are tilted from z the pitch stays away from 90 deg, and turns back.
    CHECK(most == doctest::Approx(joint == 0 ? 84.922 : 84.072).epsilon(1e-5));
  }
  // About z itself it gets there: eqs 21 and 22 divide zero by zero. Beyond, 120 deg of pitch is 60
  // deg with half a turn of roll and of yaw, whose sign the rule does not give.
  auto about_z = [](double q) -> Matrix3d { return pitch_z(q * deg).topLeftCorner<3, 3>(); };
  CHECK(std::abs(about_z(90)(1, 1)) < 1e-15);
  CHECK(std::abs(std::cos(published_from_matrix(about_z(90), 1, 1)[1])) < 1e-7);
  const auto beyond = angles_of(about_z(120), roll_pitch_yaw);
  CHECK(beyond[1] == doctest::Approx(60 * deg));
  CHECK(std::abs(beyond[0]) == doctest::Approx(180 * deg));
  CHECK(std::abs(beyond[2]) == doctest::Approx(180 * deg));
  CHECK(std::isnan(published_from_matrix(about_z(120), 0, 0)[0]));
  CHECK(std::isnan(published_from_vertices(about_z(120))[0]));
  CHECK(farthest(rotation_of(beyond, roll_pitch_yaw), about_z(120)) < 1e-14);
}
