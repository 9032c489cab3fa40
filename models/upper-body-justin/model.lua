-- Humanoid upper body, a tree: the torso (one turn about the vertical, two recorded and one passive
-- pitch joint that keeps the chest upright) carries two arms. A marker on the right hand is measured;
-- the left arm is there because its weight loads the torso. Proximal Denavit-Hartenberg form.
-- Consecutive parallel axes have a small free tilt between them.
local function mm(nominal) return nominal .. " ± 5" end
local function deg(nominal) return nominal .. " ± 3" end
local function text(number) return tostring(number) end

-- Joint 1's zero and height are the base's; those of joints 4 and 10 the shoulder's and the marker's.
-- The left arm is not measured: all of it is fixed.
local zero = { "0", deg(0), deg(0), "0", deg(0), deg(-90), deg(0), deg(-180), deg(90), "-90",
               "0", "0", "-90", "0", "0", "90", "-90" }
local encoders = {}
for i = 1, 17 do
  encoders[i] = encoder { name = "encoder" .. i, column = "q" .. i, intercept = zero[i] }
end

local mass = { [2] = "3 kg", [4] = "5 kg", [6] = "4 kg", [7] = "3.5 kg" }
local function arm(first, d, alpha, length, angle)
  local joints = {}
  for k = 2, 7 do
    joints[k - 1] = dh_proximal {
      name = "joint" .. first + k - 1, theta = "encoder" .. first + k - 1,
      d = k < 7 and length(d[k]) or "0", a = length(0), alpha = angle(alpha[k]), mass = mass[k],
    }
  end
  return joints
end

local torso_link = { name = "joint3", theta = "encoder3", mass = "8 kg", com = "150, 0, 0" }
local chest_link = { name = "passive", theta = "-(encoder2 + encoder3)", mass = "10 kg", com = "100, 0, 0" }
local function parallel(link)
  link.d, link.a, link.alpha = "0", mm(300), deg(0)
  return dh_proximal(link)
end

return talus {
  name = "Humanoid torso with two arms, Agile Justin", length = "mm", angle = "deg",
  chain {
    from = "camera", to = "chest",
    mount {
      name = "base", order = "rpy",
      x = "-2500 ± 200", y = "2000 ± 200", z = "500 ± 300", a = "0 ± 5", b = "0 ± 5", c = "90 ± 5",
    },
    dh_proximal { name = "joint1", theta = "encoder1", d = "105.5" },
    dh_proximal {
      name = "joint2", theta = "encoder2 - 90 deg", d = "0", a = mm(0), alpha = deg(-90),
      mass = "8 kg", com = "150, 0, 0",
    },
    mount { name = "tilt3", order = "rpy", b = deg(0) },
    parallel(torso_link),
    mount { name = "tilt_passive", order = "rpy", b = deg(0) },
    parallel(chest_link),
  },
  chain {
    from = "chest", to = "right_hand",
    mount {
      name = "right_shoulder", order = "rpy",
      x = "200 ± 100", y = "0 ± 100", z = "-200 ± 100", a = "0 ± 20", b = "150 ± 20", c = "0 ± 20",
    },
    dh_proximal { name = "joint4", theta = "encoder4" },
    arm(4, { 0, 0, 400, 0, 390, 0 }, { 0, 90, -90, 90, -90, 90, 90 }, mm, deg),
    mount { name = "right_marker", x = "-100 ± 200", y = "-30 ± 200", z = "100 ± 200" },
  },
  chain {
    from = "chest", to = "left_hand",
    mount {
      name = "left_shoulder", order = "rpy", x = "200", y = "0", z = "200", a = "0", b = "30", c = "0",
    },
    dh_proximal { name = "joint11", theta = "encoder11", d = "0", a = "0", alpha = "180" },
    arm(11, { 0, 0, -400, 0, -390, 0 }, { 180, 90, -90, 90, -90, -90, -90 }, text, text),
  },
  encoders,
  gravity { ["in"] = "camera", z = "-1" },
  point { name = "right_hand", ["in"] = "camera", sigma = "0.5" },
  calibrate { residual = "position", of = "right_hand" },
}
