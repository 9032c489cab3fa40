-- Three-revolute calibration device set by micrometers, measured by a coordinate measuring
-- machine. Proximal Denavit-Hartenberg form; the chain runs from the moving end m to the fixed
-- end f. 29 parameters at their initial values.
local function link(name, theta, d, alpha)
  return dh_proximal {
    name = name, theta = theta, d = d .. " ± 6", a = "0 ± 2.5", alpha = alpha .. " ± 8",
  }
end

-- Joints 1 and 3 carry the same triangle; joint 2, the flexion joint, has its own.
local narrow = { bar1 = 42.597, bar2 = 38.6255, madj = 7.8, offset = -36.0276, range = "7.5, 27.4" }
local wide = { bar1 = 44.012, bar2 = 31.75, madj = 9.73, offset = 46.1689, range = "5.4, 36.9" }

local micrometers = {}
for i, triangle in ipairs { narrow, wide, narrow } do
  micrometers[i] = micrometer_triangle {
    name = "micrometer" .. i, column = "micro" .. i,
    bar1 = triangle.bar1 .. " ± 2.5", bar2 = triangle.bar2 .. " ± 2.5",
    madj = triangle.madj .. " ± 1.5", offset = triangle.offset .. " ± 7",
    sense = "positive", sigma = "0.0012", range = triangle.range,
  }
end

-- On each end a cylinder and the seat across it; on the fixed end two more planes.
local seat = "20, 0, 0; 0, 20, 0; -20, 0, 0; 0, -20, 0"
local rings = "15, 0, 5; 0, 15, 5; -15, 0, 5; 0, -15, 5; 12, 9, 30; -9, 12, 30; -12, -9, 30; 9, -12, 30"
local function ends(body)
  return {
    cylinder { name = body .. "_cylinder", at = body, sigma = 0.0005, probe = rings },
    plane { name = body .. "_seat", at = body, sigma = 0.0005, probe = seat },
  }
end

return talus {
  name = "Calibration device, Nordquist and Hull 2009", length = "mm", angle = "deg",
  chain {
    from = "m", to = "f",
    link("moving_end", "0 ± 1", -35.56, 0),
    link("joint1", "micrometer1", -238.7346, 90),
    link("joint2", "micrometer2", 0, 90),
    link("joint3", "micrometer3", 101.6, 90),
    link("fixed_end", "90 ± 1", 35.56, 90),
  },
  micrometers,
  gravity { ["in"] = "f", z = "-1" },
  ends("f"),
  plane {
    name = "f_x", at = "f", sigma = 0.0005,
    probe = "25, -15, -30; 25, 15, -30; 25, 15, -5; 25, -15, -5",
  },
  plane {
    name = "f_y", at = "f", sigma = 0.0005,
    probe = "15, 25, -30; -15, 25, -30; -15, 25, -5; 15, 25, -5",
  },
  datum {
    name = "f_datum", origin = "f_cylinder, f_seat", primary = "z=f_cylinder", secondary = "x=f_x",
    check = "y=f_y", square = "0.2 deg",
  },
  ends("m"),
  datum { name = "m_datum", origin = "m_cylinder, m_seat", primary = "z=m_cylinder" },
  length { name = "P", ["in"] = "f", at = "m", probed = "m_datum in f_datum", sigma = "0.001" },
  direction_angles { name = "IDC", ["in"] = "f", at = "m", probed = "m_datum in f_datum", sigma = "0.002" },
  calibrate { residual = "inverse_direction_cosines, vector_length" },
}
