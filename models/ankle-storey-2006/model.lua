-- Tibia (B), talus, calcaneus (E): two skew hinges whose angles nobody measures; they are found
-- pose by pose. Frame B: x anterior, y medial, z proximal, midway between the malleoli.
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
  name = "Ankle: talocrural and subtalar hinges", length = "mm", angle = "deg",
  angles,
  chain {
    from = "B", to = "E",
    revolute(loosely { name = "talocrural", theta = "q1", x = 2, z = -3, roll = -81.9565, yaw = 5.9414 }),
    revolute(loosely { name = "subtalar", theta = "q2", y = -2, z = -18, roll = -23.4585, yaw = 43.1624 }),
    mount(loosely { name = "calcaneus", order = "rpy", x = -25, y = 4, z = -45, a = 0, b = 0, c = 0 }),
  },
  limb { name = "mortise", at = "B", length = 40, width = 64, height = 44, z = 30 },
  limb { name = "talus", at = "talocrural", length = 48, width = 40, height = 30, x = 6, z = -8 },
  limb { name = "calcaneus", at = "E", length = 74, width = 34, height = 38, x = 5, y = -4, z = 2 },
  frame { name = "E", ["in"] = "B", sigma = "0.2 mm, 0.2 deg" },
  calibrate { residual = "position, rotation_vector", of = "E" },
}
