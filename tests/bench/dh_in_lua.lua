-- The distal Denavit-Hartenberg joint, written in Lua: traced once, then as fast as the compiled one.
joint "dh_in_lua" {
  theta = coordinate(angle), d = length(0), a = length(0), alpha = angle(0),
  transform = function(p)
    return rotate_z(p.theta) * translate_z(p.d) * translate_x(p.a) * rotate_x(p.alpha)
  end
}
