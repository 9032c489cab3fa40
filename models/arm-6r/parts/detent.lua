-- A spring-loaded ball drops into the nearest of `teeth` notches around a joint and pulls it there;
-- between two notches it lets go. The reading, taken on the other side of the shaft, misses that.
effect "detent" {
  summary = "detent pulls towards the nearest notch: height sin(u) exp(2 cos(u) - 2), u = teeth r",
  acts = "reading", on = angle,
  height = amount(angle, "0.03 deg", "about half the largest pull"),
  teeth = setting(number, 12, { 6, 8, 10, 12, 16, 20, 24 }, "notches per turn"),
  value = function(around, p)
    local u = p.teeth * around.reading
    return p.height * sin(u) * exp(2 * cos(u) - 2)
  end,
}
