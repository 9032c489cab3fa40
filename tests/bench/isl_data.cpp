#include "tests/bench/isl_data.h"

#include <Eigen/Geometry>
#include <cstdio>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>

namespace talus::bench {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
constexpr double deg = std::numbers::pi / 180;

// Table 2 in its own units: mm, degrees, degrees per degree.
IslParameters from_table(IslParameters p) {
  for (int i : {3, 4, 5}) p[isl_at::base + i] *= deg, p[isl_at::end + i] *= deg;
  for (int i = 0; i < 5; ++i) p[isl_at::intercept + i] *= deg, p[isl_at::alpha + i] *= deg;
  return p;
}

// Uniform and normal numbers that do not depend on the standard library at hand.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : engine_(seed) {}
  double uniform() { return (static_cast<double>(engine_() >> 11) + 0.5) * 0x1p-53; }
  double normal(double sigma) {  // Box and Muller
    const double radius = std::sqrt(-2 * std::log(uniform()));
    return sigma * radius * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace

const IslParameters& isl_nominal() {
  static const IslParameters p = from_table({54,  -69, 0,   0,  -90, -60,  // base
                                             1,   1,   1,   1,  1,   1,    // slopes
                                             150, 0,   210, 90, 270,       // intercepts
                                             90,  90,  90,  90, 90,        // alpha
                                             0,   0,   300, 0,  0,         // a
                                             0,   300, 0,   0,  0,         // d
                                             0,   -54, 94,  90, 90,  0});  // end
  return p;
}

const IslParameters& isl_optimised() {
  static const IslParameters p = from_table({53.81,  -69.85, 0.03,   -0.14, -90.59, -64.56,  // base
                                             0.99,   0.99,   1.00,   1.01,  1.00,   1.01,  // slopes
                                             146.93, 0.21,   208.23, 89.90, 270.46,  // intercepts
                                             90.91,  89.68,  89.20,  90.87, 90.32,   // alpha
                                             0.79,   -1.89,  300.78, 0.34,  -0.54,   // a
                                             -0.02,  299.91, 0.90,   0.80,  -1.41,   // d
                                             2.79,   -53.73, 94.82,  91.91, 90.37,  -1.34});  // end
  return p;
}

IslFactors isl_published_factors() {
  const double position = std::sqrt(0.35), angle = std::sqrt(0.65) / deg;
  return {position, position, position, angle, angle, angle};
}

IslFactors isl_instrument_factors() {
  const double position = 1 / 0.005, angle = 1 / (0.002 * deg);
  return {position, position, position, angle, angle, angle};
}

IslPoses isl_poses(int count, std::uint64_t seed) {
  Noise noise(seed);
  IslPoses poses(count);
  for (IslPose& pose : poses) {
    std::array<double, 6> readings;
    for (double& reading : readings) reading = (2 * noise.uniform() - 1) * 60 * deg;
    const IslFrame<double> frame = isl_frame(isl_optimised().data(), readings.data());

    for (int i = 0; i < 6; ++i) pose.readings[i] = readings[i] + noise.normal(0.01 * deg);
    for (int i = 0; i < 3; ++i) pose.position[i] = frame.position[i] + noise.normal(0.005);
    Eigen::Vector3d turn;
    for (double& component : turn) component = noise.normal(0.002 * deg);
    Eigen::Map<RowMajor>(pose.rotation.data()) =
        Eigen::Map<const RowMajor>(frame.rotation[0]) *
        Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  }
  return poses;
}

void write_isl_recordings(const std::string& file, const IslPoses& poses) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(file.c_str(), "w"),
                                                            std::fclose);
  if (!out) throw std::runtime_error("cannot write " + file);
  std::fputs(
      "pose,theta1[deg],theta2[deg],theta3[deg],theta4[deg],theta5[deg],theta6[deg],"
      "E.x[mm],E.y[mm],E.z[mm],E.qw,E.qx,E.qy,E.qz,use\n",
      out.get());
  int number = 0;
  for (const IslPose& pose : poses) {
    std::fprintf(out.get(), "%d", ++number);
    for (double reading : pose.readings) std::fprintf(out.get(), ",%.16g", reading / deg);
    for (double coordinate : pose.position) std::fprintf(out.get(), ",%.16g", coordinate);
    const Eigen::Quaterniond q(Eigen::Map<const RowMajor>(pose.rotation.data()));
    std::fprintf(out.get(), ",%.16g,%.16g,%.16g,%.16g,fit\n", q.w(), q.x(), q.y(), q.z());
  }
  if (std::ferror(out.get())) throw std::runtime_error("cannot write " + file);
}

}  // namespace talus::bench
