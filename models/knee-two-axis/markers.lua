-- Knee in vivo during a step-up, from skin markers alone: what is measured are the ten markers, in a
-- frame laid through those of the thigh. The thigh's place in that frame and the flexion angle are
-- found frame by frame; each marker has its place on its bone. Skin that slides moves the markers
-- against each other, which no axis can do.
local thigh = {
  { 0, -50, 60 }, { 0, -70, -70 }, { 0, 70, 10 }, { -10, 20, 70 }, { 30, 0, 0 }, { -10, 40, -70 },
}
local shank = { { 0, -100, 0 }, { 0, -100, 0 }, { 0, -450, 0 }, { 0, -450, 0 } }

local knee = { name = "Knee in vivo, step-up: skin markers, one fixed hinge", length = "mm", angle = "deg" }
local function add(element) knee[#knee + 1] = element end

for _, u in ipairs { "tx", "ty", "tz" } do
  add(unknown { name = u, kind = "length", value = "0 ± 20", per = "pose" })
end
for _, u in ipairs { "ra", "rb", "rc" } do
  add(unknown { name = u, kind = "angle", value = "0 ± 20", per = "pose" })
end
add(unknown { name = "q1", kind = "angle", value = "0", per = "pose" })
add(chain {
  from = "cluster", to = "shank",
  mount { name = "thigh", order = "rpy", x = "tx", y = "ty", z = "tz", a = "ra", b = "rb", c = "rc" },
  revolute { name = "shank", theta = "q1", x = "0 ± 100", y = "-100 ± 200", roll = "0 ± 90", yaw = "0 ± 90" },
})

local rows = {}
local function markers(bone, places, room)
  local names = {}
  for i, p in ipairs(places) do
    local name = bone .. "_M0" .. i
    local function at(axis) return p[axis] .. " ± " .. room end
    add(point {
      name = name, ["in"] = "cluster", at = bone, x = at(1), y = at(2), z = at(3), sigma = "1 mm",
    })
    names[i] = name
  end
  rows[#rows + 1] = calibrate { residual = "position", of = table.concat(names, ", ") }
end
markers("thigh", thigh, 30)
markers("shank", shank, 200)
for _, r in ipairs(rows) do add(r) end

return talus(knee)
