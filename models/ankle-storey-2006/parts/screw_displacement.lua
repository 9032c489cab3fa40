-- What is left between the modelled and the measured frame is a small screw displacement. These are
-- its six coordinates in the modelled frame, the logarithm of inverse(model) * measured: the rotation
-- vector r, and the moment m = r x (-c) + slide = turn times distance of the screw's axis from the
-- frame's origin, plus the slide along it. A frame that is turned about its own origin has m = 0; the
-- distance of the axis alone, |m| / |r|, has no value where nothing is turned.
--
-- m = (1 - [r]/2 + k [r]^2) t with k = (1 - (a/2) cot(a/2)) / a^2, a = |r|: by its series, which is
-- smooth through zero and right to 1e-9 up to 60 deg.
residual "screw_displacement" {
  summary = "screw from the modelled to the measured frame: rotation vector, and moment (turn times distance of the axis, plus slide)",
  of = { "frame" },
  rows = { "rx", angle, "ry", angle, "rz", angle, "mx", length, "my", length, "mz", length },
  value = function(model, measured)
    local left = inverse(model) * measured.frame
    local rx, ry, rz = rotation_vector(left)
    local x, y, z = left:translation(1), left:translation(2), left:translation(3)
    local q = rx * rx + ry * ry + rz * rz
    local k = 1 / 12 + q * (1 / 720 + q * (1 / 30240 + q * (1 / 1209600 + q / 47900160)))
    local cx, cy, cz = ry * z - rz * y, rz * x - rx * z, rx * y - ry * x -- r x t
    local dx, dy, dz = ry * cz - rz * cy, rz * cx - rx * cz, rx * cy - ry * cx -- r x (r x t)
    return { rx, ry, rz, x - cx / 2 + k * dx, y - cy / 2 + k * dy, z - cz / 2 + k * dz }
  end,
}
