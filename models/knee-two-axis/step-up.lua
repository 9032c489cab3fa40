-- Knee in vivo during a step-up: the shank's bone moves in the thigh's about one hinge that stands
-- still. The flexion angle is found frame by frame.
local function mm(nominal) return nominal .. " ± 100" end
local function deg(nominal) return nominal .. " ± 60" end

return talus {
  name = "Knee in vivo, step-up: one fixed hinge", length = "mm", angle = "deg",
  unknown { name = "q1", kind = "angle", value = "0", per = "pose" },
  chain {
    from = "thigh", to = "shank",
    revolute { name = "flexion", theta = "q1", x = mm(0), y = mm(0), roll = deg(0), yaw = deg(0) },
    mount {
      name = "shank_bone", order = "rpy",
      x = mm(-380), y = mm(0), z = mm(0), a = deg(0), b = deg(0), c = deg(0),
    },
  },
  frame { name = "shank", ["in"] = "thigh", sigma = "1 mm, 0.6 deg" },
  calibrate { residual = "frame_points", of = "shank", arm = "100 mm" },
}
