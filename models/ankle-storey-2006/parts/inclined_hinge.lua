-- A hinge of the foot as anatomists draw it: its axis passes through a point, rises from the
-- horizontal plane by its inclination, and deviates from the foot's midline by its deviation, seen
-- from above. Frame before it: x anterior along the midline, y medial, z proximal. The axis points
-- along (cos i cos d, cos i sin d, sin i). At theta = 0 the frames before and behind are one.
joint "inclined_hinge" {
  summary = "hinge about an axis given by inclination and deviation: H Rx(theta) inverse(H), "
    .. "H = Trans(p) Rz(deviation) Ry(-inclination)",
  theta = coordinate(angle, "rotation about the axis"),
  x = length(0, "x of a point of the axis"),
  y = length(0, "y of that point"),
  z = length(0, "z of that point"),
  inclination = angle(0, "above the horizontal plane"),
  deviation = angle(0, "from the midline (x) towards medial (y), seen from above"),
  transform = function(p)
    local axis = translate(p.x, p.y, p.z) * rotate_z(p.deviation) * rotate_y(-p.inclination)
    return axis * rotate_x(p.theta) * inverse(axis)
  end,
}
