-- Six-revolute instrumented spatial linkage with encoders, measured by a coordinate measuring
-- machine: 38 parameters at their nominal values, with manufacturing tolerances.
local d = { 0, 300, 0, 0, 0 }
local a = { 0, 0, 300, 0, 0 }
local intercept = { 150, 0, 210, 90, 270 }
local mass = { 0.18, 0.26, 0.26, 0.1, 0.1, 0.12 }
local com = { "0, 0, 20", "0, 150, 0", "-150, 0, 0", "0, 0, 10", "0, 0, 10", "0, -20, 40" }

local function within(tolerance)
  return function(nominal) return nominal and nominal .. " ± " .. tolerance end
end
local mm, deg, gain = within(2), within(2), within(0.01)

-- Joint 6 has no geometry or intercept of its own: the end mount holds them.
local joints, encoders = {}, {}
for i = 1, 6 do
  joints[i] = dh {
    name = "joint" .. i, theta = "encoder" .. i,
    d = mm(d[i]), a = mm(a[i]), alpha = i < 6 and deg(90) or nil,
    mass = mass[i] .. " kg", com = com[i],
  }
  encoders[i] = encoder {
    name = "encoder" .. i, column = "theta" .. i,
    slope = gain(1), intercept = deg(intercept[i]), sigma = "0.01",
  }
end

-- Eleven points on each end: four on the face of a pin, four around it, three along the link's side.
local function probing(body)
  local face, pin, side = body .. "_face", body .. "_pin", body .. "_side"
  return {
    plane { name = face, at = body, sigma = 0.005, probe = "0, 0, 4; 4, 0, 0; 0, 0, -4; -4, 0, 0" },
    circle {
      name = pin, on = face, at = body, sigma = 0.005,
      probe = "0, -5, 5; 5, -5, 0; 0, -5, -5; -5, -5, 0",
    },
    line { name = side, at = body, sigma = 0.005, probe = "10, -12, 8; 30, -12, 8; 50, -12, 8" },
    datum { name = body .. "_datum", origin = pin, primary = "y=" .. face, secondary = "x=" .. side },
  }
end

return talus {
  name = "Instrumented spatial linkage, Bonny, Hull and Howell 2013", length = "mm", angle = "deg",
  chain {
    from = "B", to = "E",
    mount {
      name = "base", order = "zxz",
      x = mm(54), y = mm(-69), z = mm(0), a = deg(0), b = deg(-90), c = "-60 ± 5",
    },
    joints,
    mount {
      name = "end", order = "zxz",
      x = mm(0), y = mm(-54), z = mm(94), a = deg(90), b = deg(90), c = deg(0),
    },
  },
  encoders,
  gravity { ["in"] = "B", x = "-0.1696", y = "-0.2545", z = "-0.9521", held_at = "E" },
  probing("B"), probing("E"),
  frame { name = "E", ["in"] = "B", probed = "E_datum in B_datum", sigma = "0.005 mm, 0.002 deg" },
  calibrate { residual = "position, projection_angles", of = "E" },
}
