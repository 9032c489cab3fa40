-- PUMA-560-like industrial arm, its tool point measured by a laser tracker. Axes 2 and 3 are
-- nearly parallel, so joint 2 has Hayati's fifth number beta instead of an offset d. 27 free
-- parameters: complete and without redundancy.
local function mm(nominal) return nominal .. " ± 0.75" end
local function deg(nominal) return nominal .. " ± 0.3" end

-- Joint 1's zero and height belong to the base, all of joint 6's geometry to the tool.
local links = {
  { d = "0", a = mm(0), alpha = deg(-90), intercept = "0", range = "-150, 150", mass = 12, com = "0, 30, 60" },
  { d = "0", a = mm(431.8), alpha = deg(0), beta = deg(0), intercept = deg(0), range = "-120, 30", mass = 17.4, com = "-210, 6, 120" },
  { d = mm(149.09), a = mm(-20.32), alpha = deg(90), intercept = deg(0), range = "-60, 150", mass = 4.8, com = "10, -15, 40" },
  { d = mm(433.07), a = mm(0), alpha = deg(-90), intercept = deg(0), range = "-100, 100", mass = 0.82, com = "0, -80, 5" },
  { d = mm(0), a = mm(0), alpha = deg(90), intercept = deg(0), range = "-95, 95", mass = 0.34, com = "0, 0, 20" },
  { d = "0", a = "0", alpha = "0", intercept = "0", range = "-170, 170", mass = 0.09, com = "0, 0, 32" },
}

local joints, encoders = {}, {}
for i, link in ipairs(links) do
  local joint = link.beta and dh_hayati or dh
  joints[i] = joint {
    name = "joint" .. i, theta = "encoder" .. i,
    d = link.d, a = link.a, alpha = link.alpha, beta = link.beta,
    mass = link.mass .. " kg", com = link.com,
  }
  encoders[i] = encoder {
    name = "encoder" .. i, column = "theta" .. i,
    intercept = link.intercept, sigma = "0.001", range = link.range,
  }
end

return talus {
  name = "Six-revolute industrial arm and laser tracker", length = "mm", angle = "deg",
  chain {
    from = "tracker", to = "E",
    mount {
      name = "base", order = "rpy",
      x = "1500 ± 10", y = "-400 ± 10", z = "671.83 ± 10", a = "0 ± 1", b = "0 ± 1", c = "0 ± 1",
    },
    joints,
    mount { name = "tool", x = "40 ± 1", y = "15 ± 1", z = "180 ± 1" },
  },
  encoders,
  gravity { ["in"] = "base", z = "-1" },
  payload { at = "tool", column = "payload" },
  point { name = "E", ["in"] = "tracker", sigma = "0.02" },
  calibrate { residual = "position", of = "E" },
}
