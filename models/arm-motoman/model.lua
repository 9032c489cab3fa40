-- Six-revolute arm on a turntable, a reflector on its hand measured by a laser tracker. Axes 2 and 3
-- are parallel: joint 2 has Hayati's beta instead of an offset d. 27 free parameters: joint 1's zero
-- and height are the base's, joint 6's geometry is the holder's.
local function mm(nominal) return nominal .. " ± 1" end
local function deg(nominal) return nominal .. " ± 0.5" end

local links = {
  { d = "1415.9", a = mm(150), alpha = deg(-90), zero = "0", range = "-25, 4", mass = 30, com = "-75, 150, 0" },
  { d = "0", a = mm(614), alpha = deg(180), beta = deg(0), zero = deg(-90), range = "17, 67", mass = 25, com = "-300, 0, 0" },
  { d = mm(0), a = mm(200), alpha = deg(-90), zero = deg(0), range = "-58, -13", mass = 15, com = "-50, 0, 0" },
  { d = mm(-640), a = mm(0), alpha = deg(90), zero = deg(0), range = "84, 113", mass = 10, com = "0, 300, 0" },
  { d = mm(0), a = mm(30), alpha = deg(90), zero = deg(-90), range = "10, 21", mass = 4, com = "0, 0, 0" },
  { d = "200", a = "0", alpha = "0", zero = "0", range = "67, 108", mass = 1, com = "0, 0, 0" },
}

local joints, encoders = {}, {}
for i, link in ipairs(links) do
  local joint = link.beta and dh_hayati or dh
  joints[i] = joint {
    name = "joint" .. i, theta = "encoder" .. i,
    d = link.d, a = link.a, alpha = link.alpha, beta = link.beta,
    mass = link.mass .. " kg", com = link.com,
  }
  encoders[i] = encoder { name = "encoder" .. i, column = "q" .. i, intercept = link.zero, range = link.range }
end

return talus {
  name = "Motoman arm on a turntable, laser tracker", length = "mm", angle = "deg",
  chain {
    from = "tracker", to = "reflector",
    mount {
      name = "base", order = "rpy",
      x = "-500 ± 100", y = "-3950 ± 100", z = "-1480 ± 100", a = "0 ± 2", b = "0 ± 2", c = "177.3 ± 2",
    },
    dh { name = "turntable", theta = "encoder0", d = "-263", a = "0", alpha = "-15" },
    joints,
    mount { name = "holder", x = "50 ± 30", y = "0 ± 30", z = "250 ± 30" },
  },
  encoder { name = "encoder0", column = "q0", intercept = "-90" },
  encoders,
  gravity { ["in"] = "base", z = "-1" },
  point { name = "reflector", ["in"] = "tracker", sigma = "0.0035" },
  calibrate { residual = "position", of = "reflector" },
}
