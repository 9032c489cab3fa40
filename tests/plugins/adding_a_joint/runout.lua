-- Revolute joint with axial run-out, the same as runout.cpp.
joint "runout_lua" {
  summary = "revolute joint with axial run-out: Tz(runout cos(theta - phase)) Rz(theta)",
  theta = coordinate(angle, "rotation about z of A"),
  runout = length(0, "amplitude along z"),
  phase = angle(0, "theta where the run-out is largest"),
  transform = function(p)
    return translate_z(p.runout * cos(p.theta - p.phase)) * rotate_z(p.theta)
  end,
}
