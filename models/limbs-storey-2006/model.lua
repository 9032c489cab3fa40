-- Three limbs and two hinges whose axes are orthogonal to neither: offsets from the proximal limb
-- (fp) and to the distal limb (td) on both sides of each rotation. A limb's frame is at its
-- centre, x along its length; all limbs are parallel at zero.
local function loosely(value) return value .. " ± 5" end

-- A hinge with roll and yaw taken back behind it.
local function hinge(i, from, to, psi, phi, x_fp, y_fp, z_fp, x_td, y_td, z_td)
  return chain {
    from = from, to = to,
    storey { name = "joint" .. i, theta = "rotation" .. i,
      x_fp = loosely(x_fp), y_fp = loosely(y_fp), z_fp = z_fp, psi_fp = loosely(psi), phi_fp = loosely(phi),
      theta_td = loosely(0), phi_td = loosely(-phi), psi_td = loosely(-psi),
      x_td = loosely(x_td), y_td = loosely(y_td), z_td = loosely(z_td) },
  }
end

return talus {
  name = "Limbs and joints, Storey et al. 2006", length = "mm", angle = "deg",
  limb { name = "proximal", length = 120, width = 40, height = 30 },
  limb { name = "middle", length = 100, width = 36, height = 28 },
  limb { name = "distal", length = 80, width = 32, height = 24 },
  hinge(1, "proximal", "middle", 5, 10, 56, 4, -3, 54, -2, 1),
  hinge(2, "middle", "distal", 15, 20, 46, -3, 2, 44, 1, -2),
  encoder { name = "rotation1", sigma = 0.05, range = "-180, 180" },
  encoder { name = "rotation2", sigma = 0.05, range = "-180, 180" },
  frame { name = "middle", ["in"] = "proximal", sigma = "0.1 mm, 0.1 deg" },
  frame { name = "distal", ["in"] = "proximal", sigma = "0.1 mm, 0.1 deg" },
  calibrate { residual = "position, rotation_vector", of = "middle, distal" },
}
