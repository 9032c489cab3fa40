-- One rotary axis: the angle that a resolver shows against the drive's step counter. Free are
-- the offset between the two and the scale.
return talus {
  name = "Resolver against step counter", length = "mm", angle = "deg",
  chain { from = "base", to = "shaft", revolute { name = "q1", theta = "counter" } },
  encoder { name = "counter", column = "q1", slope = "1 ± 0.02", intercept = "0 ± 5", range = "0, 360" },
  turn { name = "resolver", ["in"] = "base", at = "shaft", sigma = "0.01 deg" },
  calibrate { residual = "turn", of = "resolver" },
}
