#include "tests/engine/world.h"

#include <unistd.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <stdexcept>

#include "tests/engine/mjcf.h"

namespace engine {
namespace {

using Kind = Flaw::Kind;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

bool has(const Linkage& l, Kind kind) {
  for (const Flaw& f : l.flaws)
    if (f.kind == kind) return true;
  return false;
}

}  // namespace

World::World(const Linkage& linkage) : linkage_(linkage) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("talus_engine_" + std::to_string(::getpid()) + ".xml");
  std::ofstream(file) << mjcf(linkage);
  char error[1000] = "";
  model_.reset(mj_loadXML(file.c_str(), nullptr, error, sizeof error));
  std::filesystem::remove(file);
  if (!model_) throw std::runtime_error(std::string("the engine refuses the linkage: ") + error);
  data_.reset(mj_makeData(model_.get()));
}

int World::id(mjtObj kind, const std::string& name) const {
  const int found = mj_name2id(model_.get(), kind, name.c_str());
  if (found < 0) throw std::runtime_error("the engine has no " + name);
  return found;
}

void World::look() const {
  mju_zero(data_->qvel, model_->nv);
  mj_fwdPosition(model_.get(), data_.get());
  mj_fwdVelocity(model_.get(), data_.get());
}

void World::weigh() {
  Eigen::Vector3d g(linkage_.gravity.data());
  g *= 9.81 / g.norm();
  if (linkage_.gravity_in_base) {
    mj_kinematics(model_.get(), data_.get());
    g = RowMajor3(data_->xmat + 9 * id(mjOBJ_BODY, "base")) * g;
  }
  for (int i = 0; i < 3; ++i) model_->opt.gravity[i] = g[i];
}

void World::payload(double kg) {
  model_->body_mass[id(mjOBJ_BODY, "payload")] = std::max(kg, 1e-7);
}

void World::turn(int joint, double angle) {
  const std::string n = std::to_string(joint);
  if (linkage_.held) {
    data_->qpos[model_->jnt_qposadr[id(mjOBJ_JOINT, "hinge" + n)]] = angle;
    return;
  }
  mjtNum* quaternion = model_->body_quat + 4 * id(mjOBJ_BODY, "motor" + n);
  const mjtNum axis[] = {0, 0, 1};
  mju_axisAngle2Quat(quaternion, axis, angle);
  if (const Flaw* f = linkage_.flaw(Kind::play_approach, joint)) {
    const double half = f->size * std::numbers::pi / 180;
    mjtNum* range = model_->jnt_range + 2 * id(mjOBJ_JOINT, "drag" + n);
    range[0] = angle - half, range[1] = angle + half;
  }
}

void World::place(const Angles& angles) {
  mju_zero(data_->qpos, model_->nq);
  mju_zero(data_->qvel, model_->nv);
  for (int i = 1; i <= 6; ++i) {
    turn(i, angles[i - 1]);
    if (linkage_.flaw(Kind::play_approach, i))
      data_->qpos[model_->jnt_qposadr[id(mjOBJ_JOINT, "drag" + std::to_string(i))]] = angles[i - 1];
  }
  mj_kinematics(model_.get(), data_.get());
  const int end_body = id(mjOBJ_BODY, "end");
  mju_copy(data_->mocap_pos, data_->xpos + 3 * end_body, 3);
  mju_copy(data_->mocap_quat, data_->xquat + 4 * end_body, 4);
  weigh();
}

void World::rest(const Angles& angles, const std::array<int, 6>& sense) {
  place(angles);
  if (has(linkage_, Kind::play_approach)) {
    constexpr int steps = 1000;
    constexpr double swing = 2 * std::numbers::pi / 180;
    for (int s = 0; s <= steps; ++s) {
      for (int i = 1; i <= 6; ++i)
        if (const Flaw* f = linkage_.flaw(Kind::play_approach, i)) {
          const double ahead = 1 - double(s) / steps;  // slows down to the end
          const double angle = angles[i - 1] - sense[i - 1] * swing * ahead * ahead;
          turn(i, angle);
          if (s == 0)
            data_->qpos[model_->jnt_qposadr[id(mjOBJ_JOINT, "drag" + std::to_string(i))]] =
                angle - sense[i - 1] * f->size * std::numbers::pi / 180;
        }
      mj_step(model_.get(), data_.get());
    }
    for (int s = 0; s < steps / 4; ++s) mj_step(model_.get(), data_.get());
  } else if (has(linkage_, Kind::play_load) || has(linkage_, Kind::clearance)) {
    settle();
  } else if (model_->nv > 0) {
    balance();
  }
  mj_kinematics(model_.get(), data_.get());
}

// Springs' K, the loop's J: K dq - J^T force = passive - bias, J dq = -gap.
void World::balance() {
  const int n = model_->nv;
  Eigen::VectorXd stiffness(n);
  for (int i = 0; i < n; ++i) stiffness[i] = model_->jnt_stiffness[model_->dof_jntid[i]];
  for (int step = 0; step < 100; ++step) {
    look();
    const int c = data_->ne;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n + c, n + c);
    Eigen::VectorXd b(n + c);
    A.topLeftCorner(n, n) = stiffness.asDiagonal();
    b.head(n) = Eigen::Map<Eigen::VectorXd>(data_->qfrc_passive, n) -
                Eigen::Map<Eigen::VectorXd>(data_->qfrc_bias, n);
    if (c > 0) {
      const Eigen::Map<const Rows> J(data_->efc_J, c, n);
      A.topRightCorner(n, c) = -J.transpose();
      A.bottomLeftCorner(c, n) = J;
      b.tail(c) = -Eigen::Map<Eigen::VectorXd>(data_->efc_pos, c);
    }
    const Eigen::VectorXd dq = A.partialPivLu().solve(b).head(n);
    for (int i = 0; i < n; ++i) data_->qpos[i] += dq[i];
    if (!(dq.norm() < 1)) break;
    if (dq.norm() < 1e-11) return;
  }
  throw std::runtime_error("no equilibrium found");
}

void World::settle() {
  constexpr int most = 40000;
  int still = 0;
  for (int s = 0; s < most && still < 20; ++s) {
    mj_step(model_.get(), data_.get());
    double fastest = 0;
    for (int i = 0; i < model_->nv; ++i) fastest = std::max(fastest, std::abs(data_->qvel[i]));
    still = fastest < 1e-7 ? still + 1 : 0;
  }
}

Eigen::Isometry3d World::end() const {
  const int body = id(mjOBJ_BODY, "end");
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = RowMajor3(data_->xmat + 9 * body);
  T.translation() = Eigen::Map<Eigen::Vector3d>(data_->xpos + 3 * body);
  return T;
}

// The disc's lines are counted from its own centre: what stands under the head is the direction
// from there to the head, as the disc sees it.
Angles World::encoders() const {
  Angles result{};
  for (int i = 1; i <= 6; ++i) {
    const std::string n = std::to_string(i);
    auto site = [&](const std::string& name) {
      return Eigen::Vector3d(data_->site_xpos + 3 * id(mjOBJ_SITE, name + n));
    };
    const RowMajor3 disc(data_->xmat + 9 * id(mjOBJ_BODY, "motor" + n));
    const Eigen::Vector3d to_head = disc.transpose() * (site("head") - site("disc"));
    result[i - 1] = -std::atan2(to_head[1], to_head[0]);
  }
  return result;
}

double World::regularity() const {
  look();
  constexpr double arm = 0.3;  // m, that makes lengths of angles
  Rows place_rows(3, model_->nv), turn_rows(3, model_->nv);
  mj_jacBody(model_.get(), data_.get(), place_rows.data(), turn_rows.data(), id(mjOBJ_BODY, "end"));
  Eigen::Matrix<double, 6, 6> J;
  for (int i = 1; i <= 6; ++i) {
    const int dof = model_->jnt_dofadr[id(mjOBJ_JOINT, "hinge" + std::to_string(i))];
    J.col(i - 1) << place_rows.col(dof) / arm, turn_rows.col(dof);
  }
  return Eigen::JacobiSVD<Eigen::Matrix<double, 6, 6>>(J).singularValues()[5];
}

}  // namespace engine
