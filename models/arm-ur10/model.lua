-- UR10 with a target of six degrees of freedom on its flange, measured by a laser tracker. Axes 2, 3
-- and 4 are parallel: joints 2 and 3 have Hayati's beta instead of an offset d. 30 free parameters:
-- joint 1's zero and height are the base's, joint 6's geometry is the tool's.
local function mm(nominal) return nominal .. " ± 2" end
local function deg(nominal) return nominal .. " ± 1" end

local links = {
  { d = "127.3", a = mm(0), alpha = deg(90), zero = "0", range = "-178, 40", mass = 7.778, com = "21, 0, 27" },
  { d = "0", a = mm(-612), alpha = deg(0), beta = deg(0), zero = deg(0), range = "-177, 7", mass = 12.93, com = "380, 0, 158" },
  { d = "0", a = mm(-572.3), alpha = deg(0), beta = deg(0), zero = deg(0), range = "-136, 119", mass = 3.87, com = "240, 0, 68" },
  { d = mm(163.941), a = mm(0), alpha = deg(90), zero = deg(0), range = "-180, 172", mass = 1.96, com = "0, 7, 18" },
  { d = mm(115.7), a = mm(0), alpha = deg(-90), zero = deg(0), range = "-140, 128", mass = 1.96, com = "0, 7, 18" },
  { d = "92.2", a = "0", alpha = "0", zero = "0", range = "-180, 180", mass = 0.202, com = "0, 0, -26" },
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
  name = "UR10 and laser tracker with T-Mac", length = "mm", angle = "deg",
  chain {
    from = "tracker", to = "TMac",
    mount {
      name = "base", order = "rpy",
      x = "2690 ± 50", y = "-1540 ± 50", z = "-1310 ± 50", a = "0 ± 2", b = "0 ± 2", c = "-30 ± 2",
    },
    joints,
    mount {
      name = "tool", order = "rpy",
      x = "0 ± 20", y = "0 ± 20", z = "109 ± 20", a = "0 ± 10", b = "0 ± 10", c = "-90 ± 10",
      mass = "0.7 kg", com = "0, 0, 0",
    },
  },
  encoders,
  gravity { ["in"] = "base", z = "-1" },
  frame { name = "TMac", ["in"] = "tracker", sigma = "0.01 mm, 0.01 deg" },
  calibrate { residual = "position, rotation_vector", of = "TMac" },
}
