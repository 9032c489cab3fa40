-- Telescope mount of two axes, measured by stars. Frame sky: x east, y north, z up. Azimuth counts
-- from north through east, so it turns about -z. The six pointing terms in the words of the trade:
-- IA, IE are the intercepts, AN and AW the pier's a and b, NPAE the elevation axis' yaw, CA the line of
-- sight's yaw.
local function small(nominal) return nominal .. " ± 0.1" end

local encoders = {}
for i, axis in ipairs { { column = "raw_az", range = "0, 360" }, { column = "raw_el", range = "17, 88" } } do
  encoders[i] = encoder { name = "encoder" .. i, column = axis.column, intercept = "0 ± 1", range = axis.range }
end

return talus {
  name = "Alt-azimuth telescope mount", length = "mm", angle = "deg",
  chain {
    from = "sky", to = "telescope",
    mount { name = "pier", order = "rpy", a = small(0), b = small(0) },
    revolute { name = "azimuth", theta = "-encoder1" },
    revolute { name = "elevation", theta = "encoder2", yaw = small(90), mass = "1000 kg", com = "0, 1000, 0" },
  },
  encoders,
  gravity { ["in"] = "sky", z = "-1" },
  direction { name = "d", ["in"] = "sky", at = "telescope", roll = "-90", yaw = small(0), sigma = "1 arcsec" },
  calibrate { residual = "direction", of = "d", group = "star" },
}
