-- Seven-revolute arm whose tip is a ball, held by hand in one of the two sockets of a plate while the
-- arm moves; no instrument measures anything. The plate's place is unknown at each location; its
-- sockets are 50 mm apart. Proximal Denavit-Hartenberg form. Joint 1 is fixed: it is the world.
-- 25 free parameters.
local d = { 333, 0, 316, 0, 384, 0, 107 }
local a = { 0, 0, 0, 82.5, -82.5, 0, 88 }
local alpha = { 0, -90, 90, 90, -90, 90, 90 }
local mass = { 4.971, 0.647, 3.229, 3.588, 1.226, 1.667, 0.736 }
local com = {
  "4, 2, -48", "-3, -29, 3", "28, 39, -67", "-53, 104, 27", "-12, 41, -38", "60, -14, -11", "11, -4, -45",
}
local range = { "-166, 166", "-101, 101", "-166, 166", "-176, -4", "-166, 166", "-1, 215", "-166, 166" }

local function free(nominal, tolerance, is_free)
  return nominal .. (is_free and " ± " .. tolerance or "")
end

-- Joint 1 is the world; joint 7's zero and offset are the tip's.
local joints, encoders = {}, {}
for i = 1, 7 do
  local geometry, zero = i > 1, i > 1 and i < 7
  joints[i] = dh_proximal {
    name = "joint" .. i, theta = "encoder" .. i,
    d = free(d[i], 2, zero), a = free(a[i], 2, geometry), alpha = free(alpha[i], 1, geometry),
    mass = mass[i] .. " kg", com = com[i],
  }
  encoders[i] = encoder {
    name = "encoder" .. i, column = "q" .. i, intercept = free(0, 1, zero), range = range[i],
  }
end

local function place(name, kind, start)
  return unknown { name = name, kind = kind, value = start, per = "location" }
end

return talus {
  name = "Panda arm, ball in sockets", length = "mm", angle = "deg",
  place("plate_x", "length", "500"), place("plate_y", "length", "0"), place("plate_z", "length", "0"),
  place("plate_azimuth", "angle", "90"), place("plate_elevation", "angle", "0"),
  place("span", "length", "50 ± 0.1"),
  chain {
    from = "base", to = "ball",
    joints,
    mount { name = "tip", x = "0 ± 20", y = "0 ± 20", z = "40 ± 100" },
  },
  chain {
    from = "base", to = "socket",
    mount {
      name = "plate", order = "rpy", x = "plate_x", y = "plate_y", z = "plate_z",
      a = "0", b = "-plate_elevation", c = "plate_azimuth",
    },
    mount { name = "hole_on_plate", x = "span * hole" },
  },
  encoders,
  covariate { name = "hole", column = "hole" },
  gravity { ["in"] = "base", z = "-1" },
  closure { name = "contact", ["in"] = "socket", at = "ball", sigma = "0.2" },
  calibrate { residual = "position", of = "contact" },
}
