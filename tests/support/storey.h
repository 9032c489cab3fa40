// Storey et al. 2006: the published procedure on the vertices matrix, written out as matrices.
//
// Where the procedure does not work as it is printed is told by `Printed` and asserted in
// tests/plugins/storey_test.cpp. Offsets, displacements and limbs are those of
// models/limbs-storey-2006.
#pragma once

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <string>
#include <vector>

#include "framework/kinematics/posture.h"
#include "framework/model/quantity.h"
#include "tests/support/models.h"

namespace talus::testing::storey {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

// Eqs 2-5.
inline Matrix4d translation(const Vector3d& d) {
  Matrix4d T = Matrix4d::Identity();
  T.topRightCorner<3, 1>() = d;
  return T;
}
inline Matrix4d roll_x(double psi) {
  Matrix4d R = Matrix4d::Identity();
  R(1, 1) = R(2, 2) = std::cos(psi), R(2, 1) = std::sin(psi), R(1, 2) = -R(2, 1);
  return R;
}
inline Matrix4d yaw_y(double phi) {
  Matrix4d R = Matrix4d::Identity();
  R(0, 0) = R(2, 2) = std::cos(phi), R(0, 2) = std::sin(phi), R(2, 0) = -R(0, 2);
  return R;
}
inline Matrix4d pitch_z(double theta) {
  Matrix4d R = Matrix4d::Identity();
  R(0, 0) = R(1, 1) = std::cos(theta), R(1, 0) = std::sin(theta), R(0, 1) = -R(1, 0);
  return R;
}

struct Joint {
  Vector3d fp, td;                  // displacements
  double psi_fp, phi_fp, theta_fp;  // offsets from the proximal limb; theta_fp takes up the turns
  double theta_td, phi_td, psi_td;  // and to the distal one
  Matrix4d axis() const { return translation(fp) * roll_x(psi_fp) * yaw_y(phi_fp); }
  Matrix4d behind() const {
    return pitch_z(theta_td) * yaw_y(phi_td) * roll_x(psi_td) * translation(td);
  }
  Matrix4d whole() const { return axis() * pitch_z(theta_fp) * behind(); }
};

// What the paper prints otherwise than it can have been done.
struct Printed {
  bool proximal_first = false;  // sec. III builds limb 1 first: limb 2 gets M2 M1 instead of M1 M2
  bool from_selected = false;   // sec. IV returns from joint # on, which step 8 has placed already
  bool held = false;            // sec. IV takes back initial offsets, though joints have turned
};

// The vertices matrix: twelve columns per limb; V_# are the columns of the limbs distal to joint #.
struct Vertices {
  std::vector<Joint> joints;
  MatrixXd V;
  Printed printed;

  Vertices(std::vector<Joint> js, const std::vector<LimbPoints>& limbs, Printed p = {})
      : joints(std::move(js)), V(4, 12 * limbs.size()), printed(p) {
    for (std::size_t i = 0; i < limbs.size(); ++i) {
      V.block<3, 12>(0, 12 * static_cast<Eigen::Index>(i)) = limbs[i];
      V.block<1, 12>(3, 12 * static_cast<Eigen::Index>(i)).setOnes();
    }
    const int d = static_cast<int>(joints.size());  // sec. III
    for (int n = 0; n < d; ++n) {
      const int joint = printed.proximal_first ? n : d - 1 - n;
      move(joint, joints[joint].whole());
    }
  }
  void move(int joint, const Matrix4d& M) {
    auto distal = V.rightCols(V.cols() - 12 * (joint + 1));
    distal = (M * distal).eval();
  }
  // Sec. IV: back to the selected joint, turn, and return.
  void rotate(int selected, double turn) {
    for (int j = 0; j <= selected; ++j) {
      move(j, joints[j].axis().inverse());  // [R_y]^-1 [R_x]^-1 [T]^-1
      if (j == selected) break;
      const double theta = printed.held ? 0 : joints[j].theta_fp;
      move(j, (pitch_z(theta) * joints[j].behind()).inverse());
    }
    move(selected, joints[selected].axis() * pitch_z(turn));  // [T][R_x][R_y][Rev]
    if (!printed.held) joints[selected].theta_fp += turn;
    for (int j = printed.from_selected ? selected : selected - 1; j >= 0; --j)
      move(j, joints[j].whole());
  }
};

// The joints as the model has them at zero.
inline std::vector<Joint> joints_of(const Model& model) {
  std::vector<Joint> result;
  Model copy = model;
  for (Element& chain : copy.root.children) {
    if (chain.tag != "chain") continue;
    for (Element& joint : chain.children) {
      auto value = [&](const char* name) {
        const Attribute* a = joint.find(name);
        const Dimension d = std::string(name).size() == 4 ? talus::length : angle;  // "x_fp"
        return a ? parse_quantity(a->text, d, {}, a->place).value : 0;
      };
      result.push_back({{value("x_fp"), value("y_fp"), value("z_fp")},
                        {value("x_td"), value("y_td"), value("z_td")},
                        value("psi_fp"),
                        value("phi_fp"),
                        value("theta_fp"),
                        value("theta_td"),
                        value("phi_td"),
                        value("psi_td")});
    }
  }
  return result;
}

struct Device {
  Model model = model_of(shipped("limbs-storey-2006/model.xml"));
  Program program = program_of(model);
  std::vector<Joint> joints = joints_of(model);
  std::vector<LimbPoints> limbs;
  Device() {
    for (const Limb& limb : program.limbs) limbs.push_back(points(limb));
  }
  // The vertices by the model's forward kinematics.
  MatrixXd forward(const std::vector<double>& turns) const {
    Posture posture(program);
    posture.set(turns);
    MatrixXd V(4, 12 * limbs.size());
    V.setOnes();
    for (std::size_t i = 0; i < limbs.size(); ++i)
      V.block<3, 12>(0, 12 * static_cast<Eigen::Index>(i)) =
          (posture.frame(program.limbs[i].frame) * limbs[i]).eval();
    return V;
  }
};

inline double farthest(const MatrixXd& a, const MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

}  // namespace talus::testing::storey
