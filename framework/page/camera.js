// An orthographic view: from which side (azimuth and elevation about the axis that points up, rad),
// at what, how large (pixels per mm).
import { add, cross, dot, sub, times } from "./linkage.js";

const bases = { z: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], y: [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
                x: [[0, 1, 0], [0, 0, 1], [1, 0, 0]] };

export class Camera {
  constructor() {
    this.up = "z";
    this.azimuth = -Math.PI / 3;
    this.elevation = 25 * Math.PI / 180;
    this.target = [0, 0, 0];
    this.scale = 1;
    this.width = this.height = 100;
  }
  basis() {
    const sign = this.up[0] === "-" ? -1 : 1, [e1, e2, e3] = bases[this.up.at(-1)];
    const ca = Math.cos(this.azimuth), sa = Math.sin(this.azimuth);
    const ce = Math.cos(this.elevation), se = Math.sin(this.elevation);
    const [a, b, c] = [times(sign, e1), e2, times(sign, e3)];
    const towards = add(add(times(ce * ca, a), times(ce * sa, b)), times(se, c));
    const right = add(times(-sa, a), times(ca, b));
    return { towards, right, up: cross(towards, right) };
  }
  // Pixels from the upper left corner, and how near.
  project(p) {
    const { towards, right, up } = this.basis(), d = sub(p, this.target);
    return [this.width / 2 + this.scale * dot(d, right), this.height / 2 - this.scale * dot(d, up),
            dot(d, towards)];
  }
  fit(extent) {
    this.target = times(0.5, add(extent.low, extent.high));
    const { right, up } = this.basis();
    const range = axis => {
      const along = extent.points.map(p => dot(sub(p, this.target), axis));
      return [Math.min(...along), Math.max(...along)];
    };
    const [l, r] = range(right), [b, t] = range(up), rim = 0.09 * extent.size;
    this.target = add(this.target, add(times((l + r) / 2, right), times((b + t) / 2, up)));
    this.fitted = this.scale = Math.min(this.width / (r - l + 2 * rim), this.height / (t - b + 2 * rim));
  }
  orbit(dx, dy) {
    this.azimuth -= dx;
    this.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.elevation + dy));
  }
  pan(dx, dy) {
    const { right, up } = this.basis();
    this.target = add(this.target, add(times(-dx / this.scale, right), times(dy / this.scale, up)));
  }
}
