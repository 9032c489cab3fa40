-- Femur (B) and tibia (E): the flexion axis stands still in the femur, the longitudinal-rotation
-- axis in the tibia (given here in B at zero flexion). The two angles are found pose by pose.
-- Frame B: x anterior, y medial, z proximal.
local function loosely(values)
  for key, value in pairs(values) do
    if type(value) == "number" then values[key] = value .. " ± 10" end
  end
  return values
end

local angles = {}
for i = 1, 2 do
  angles[i] = unknown { name = "q" .. i, kind = "angle", value = "0", per = "pose" }
end

return talus {
  name = "Knee: flexion-extension and longitudinal-rotation axes", length = "mm", angle = "deg",
  angles,
  chain {
    from = "B", to = "E",
    revolute(loosely { name = "flexion", theta = "q1", x = 0, z = 0, roll = -88.8542, yaw = 1.718 }),
    revolute(loosely { name = "rotation", theta = "q2", x = 8, y = 3, roll = 1.7184, yaw = 1.1452 }),
    mount(loosely { name = "tibia", order = "rpy", x = 5, y = 0, z = -60, a = 0, b = 0, c = 0 }),
  },
  frame { name = "E", ["in"] = "B", sigma = "0.1 mm, 0.1 deg" },
  calibrate { residual = "position, rotation_vector", of = "E" },
}
