// One built linkage in the engine: placed, brought to rest, looked at.
//
// What is elastic comes to rest by Newton steps on the engine's forces (gravity, springs, the
// closed loop); what is loose by damped motion in time until it lies still, for the engine alone
// knows which stop it lies on.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <memory>

#include "tests/engine/linkage.h"

namespace engine {

using Angles = std::array<double, 6>;  // rad

class World {
 public:
  explicit World(const Linkage& linkage);

  void payload(double kg);
  // Turns the motors of a driven linkage, or puts a held one's end where these angles lead.
  void place(const Angles& angles);
  // Brings it to rest. Where play is closed by the approach, the motors come from `sense`.
  void rest(const Angles& angles, const std::array<int, 6>& sense);

  Eigen::Isometry3d end() const;  // in the frame of the measurement
  Angles encoders() const;        // what the discs show to the read heads, within half a turn
  // Of a held linkage: how far its hinges are from a singular posture, 0 at one.
  double regularity() const;

 private:
  int id(mjtObj kind, const std::string& name) const;
  void look() const;  // positions and forces at the present coordinates
  void weigh();       // gravity, seen from where it is stated
  void balance();     // Newton
  void settle();      // time
  void turn(int joint, double angle);
  void unload();  // springs and stops to zero

  struct Free {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
    void operator()(mjData* d) const { mj_deleteData(d); }
  };
  Linkage linkage_;
  std::unique_ptr<mjModel, Free> model_;
  std::unique_ptr<mjData, Free> data_;
};

}  // namespace engine
