// A linkage at a posture as simple shapes: rods, boxes, cones, balls, lines and names. Both
// painters (webgl.js, canvas.js) draw these and nothing else.
//
// `size` (mm) is that of the whole; what is drawn to be seen (axes, triads) is a share of it.
import { add, axisLine, column, consecutive, cross, isPoint, norm, origin, placed, point, sub,
         times, turned, unit } from "./linkage.js";

export function extentOf(scene, values) {
  const points = [];
  const take = p => { if (isPoint(p)) points.push(p); };
  for (const bone of scene.bones)
    bone.points.forEach((at, i) => {
      if (!bone.far || i === bone.points.length - 1) take(point(values, at));
    });
  for (const f of scene.features) take(origin(values, f.at));
  scene.frames.forEach((f, i) => { if (i > 0 && f.main) take(origin(values, f.at)); });
  for (const limb of scene.limbs)
    for (let corner = 0; corner < 8; ++corner)
      take(placed(values, scene.frames[limb.frame].at, limb.centre.map(
        (c, i) => c + limb.size[i] * ((corner >> i & 1) - 0.5))));
  if (!points.length) points.push([0, 0, 0]);
  const bounds = () => [Math.min, Math.max].map(f => [0, 1, 2].map(i => f(...points.map(p => p[i]))));
  let [low, high] = bounds(), size = norm(sub(high, low));
  if (!(size > 1e-9)) {  // all in one point: room for the joints
    size = 100;
    for (const s of [-0.07, 0.07]) for (let i = 0; i < 3; ++i) points.push(points[0].map((v, k) => v + (k === i ? s * size : 0)));
  }
  for (const f of scene.features) if (f.kind === "direction") take(directionTip(values, f, size));
  [low, high] = bounds();
  return { points, low, high, size };
}
const directionTip = (values, feature, size) => placed(values, feature.at, [0, 0, 0.13 * size]);

// options: size, colours, show {bodies, joints, frames, apart, features, names}, ghost (a colour:
// thin lines only), format {length, angle} for numbers in names.
export function shapesOf(scene, values, options) {
  const { size, colours, ghost } = options, show = options.show ?? {};
  const u = size / 1000, out = { rods: [], boxes: [], cones: [], balls: [], lines: [], names: [] };
  const line = (a, b, colour, width = 1, dash = 0, key = null) => {
    if (isPoint(a) && isPoint(b)) out.lines.push({ a, b, colour: ghost ?? colour, width, dash, key });
  };
  const name = (at, text, colour, kind, key = null) => {
    if (!ghost && show.names !== false && isPoint(at)) out.names.push({ at, text, colour, kind, key });
  };
  const arrow = (a, b, colour, width, key = null) => {
    line(a, b, colour, width, 0, key);
    const d = sub(b, a), length = norm(d);
    if (isPoint(d) && length > 1e-9)
      out.cones.push({ at: b, direction: unit(d), length: Math.min(18 * u, 0.5 * length),
                       radius: Math.min(6 * u, 0.17 * length), colour: ghost ?? colour, key });
  };
  const rod = (a, b, radius, colour, key) => {
    if (isPoint(a) && isPoint(b) && norm(sub(b, a)) > 0.05 * u)
      out.rods.push({ a, b, radius, colour, key });
  };
  const farther = bone => {  // a root too far to be shown: a dashed line towards it
    const to = point(values, bone.points.at(-1)), from = point(values, bone.points[0]);
    return add(to, times(0.3 * size, unit(sub(from, to))));
  };
  const far = scene.bones.find(bone => bone.far);
  const rootAt = far ? farther(far) : null;

  if (show.bodies !== false) for (const bone of scene.bones) {
    const points = bone.points.map(at => point(values, at));
    if (bone.far) {
      line(rootAt, points.at(-1), colours.stem, 1.5, 8 * u);
      const away = norm(sub(points.at(-1), points[0]));
      if (options.format)
        name(times(0.5, add(rootAt, points.at(-1))), options.format.length(away), colours.faint, "note");
      continue;
    }
    if (bone.limbed) continue;
    const key = "frame:" + bone.from;
    points.slice(1).forEach((p, i) => {
      if (ghost) return line(points[i], p, ghost, 1.6);
      rod(points[i], p, (bone.stem ? 2.6 : 8) * u,
          bone.stem ? colours.stem : bone.body % 2 ? colours.rod : colours.rod2, key);
      if (!bone.stem && i > 0) out.balls.push({ at: points[i], radius: 8 * u,
        colour: bone.body % 2 ? colours.rod : colours.rod2, key });
    });
  }
  if (show.bodies !== false) scene.limbs.forEach((limb, i) => {
    const at = scene.frames[limb.frame].at, half = times(0.5, limb.size);
    const corner = c => placed(values, at, limb.centre.map((v, k) => v + (c >> k & 1 ? half[k] : -half[k])));
    if (isPoint(corner(0)) && !ghost)
      out.boxes.push({ corners: [0, 1, 2, 3, 4, 5, 6, 7].map(corner),
        centre: placed(values, at, limb.centre), size: limb.size,
        axes: [0, 1, 2].map(j => column(values, at, j)),
        colour: colours.limbs[i % colours.limbs.length], key: "frame:" + limb.frame });
    for (const [a, b] of [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5],
                          [2, 6], [3, 7]])
      line(corner(a), corner(b), colours.faint, 1);
    if (limb.name !== scene.frames[limb.frame].label)
      name(placed(values, at, limb.centre), limb.name, colours.faint, "limb");
  });

  if (show.joints !== false) scene.axes.forEach((axis, i) => {
    const l = axisLine(scene, values, axis);
    if (!l || !axis.moves || !isPoint(l.centre)) return;
    const key = "joint:" + axis.joint, n = Math.min(5, axis.met);
    const radius = 15 * u * 0.74 ** n, half = 24 * u * 1.32 ** n;
    const reach = times(half + 46 * u, l.direction);
    if (ghost) return line(sub(l.centre, times(0.7, reach)), add(l.centre, times(0.7, reach)), ghost, 1, 6 * u);
    if (l.turns) {
      rod(sub(l.centre, times(half, l.direction)), add(l.centre, times(half, l.direction)), radius,
          colours.joint, key);
    } else {
      const x = unit(cross(l.direction, Math.abs(l.direction[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
      const y = cross(l.direction, x), s = [radius, radius, half];
      const corner = c => add(l.centre, add(add(times(c & 1 ? s[0] : -s[0], x),
        times(c & 2 ? s[1] : -s[1], y)), times(c & 4 ? s[2] : -s[2], l.direction)));
      out.boxes.push({ corners: [0, 1, 2, 3, 4, 5, 6, 7].map(corner), centre: l.centre,
        size: times(2, s), axes: [x, y, l.direction], colour: colours.joint, solid: true, key });
    }
    line(sub(l.centre, reach), l.centre, colours.axis, 1.4, 7 * u, key);
    arrow(l.centre, add(l.centre, reach), colours.axis, 1.4, key);
    name(add(l.centre, times(1.08, reach)), axis.joint, colours.axis, "joint", key);
  });

  if (show.apart && !ghost) for (const pair of consecutive(scene, values)) {
    if (!(pair.distance > 1e-6 * size)) continue;
    line(pair.from, pair.to, colours.apart, 2.4);
    for (const p of [pair.from, pair.to]) out.balls.push({ at: p, radius: 4 * u, colour: colours.apart });
    if (options.format)
      name(times(0.5, add(pair.from, pair.to)),
           `${options.format.angle(pair.angle)}, ${options.format.length(pair.distance)}`, colours.apart, "apart");
  }

  if (show.frames !== false) scene.frames.forEach((f, i) => {
    if (show.frames !== "all" && !f.main) return;
    if (ghost && !f.main) return;
    const o = i === 0 && rootAt ? rootAt : origin(values, f.at), key = "frame:" + i;
    ["x", "y", "z"].forEach((axis, j) => {
      const tip = add(o, times((ghost ? 40 : 60) * u, column(values, f.at, j)));
      ghost ? line(o, tip, ghost, 1.2) : arrow(o, tip, colours[axis], 2.4, key);
      if (!ghost) name(add(o, times(72 * u, column(values, f.at, j))), axis, colours[axis], "axis", key);
    });
    name(sub(o, times(14 * u, add(add(column(values, f.at, 0), column(values, f.at, 1)),
      column(values, f.at, 2)))), f.label, colours.ink, "frame", key);
  });

  if (show.features !== false && !ghost) for (const f of scene.features) {
    const p = origin(values, f.at), from = f.in === 0 && rootAt ? rootAt
      : origin(values, scene.frames[f.in].at);
    const held = origin(values, scene.frames[f.frame].at), key = "feature:" + f.name;
    if (!isPoint(p)) continue;
    if (norm(sub(p, held)) > u) line(held, p, colours.stem, 1.4);
    if (f.kind === "scalar") line(from, p, colours.feature, 1, 7 * u);
    if (f.kind === "nothing") line(from, p, colours.feature, 1.2, 4 * u);
    if (f.kind === "direction") arrow(p, directionTip(values, f, size), colours.feature, 1.6, key);
    out.balls.push({ at: p, radius: 7 * u, colour: colours.feature, key });
    if (f.name !== scene.frames[f.frame].label)
      name(f.kind === "scalar" ? times(0.5, add(from, p)) : add(p, [0, 0, 16 * u]), f.name, colours.feature,
           "feature", key);
  }
  return out;
}

// Marks put beside the linkage: arrows [{from, to, colour}] and crosses [{at, colour}].
export function markShapes(marks, size) {
  const u = size / 1000, out = { rods: [], boxes: [], cones: [], balls: [], lines: [], names: [] };
  for (const m of marks) {
    if (m.at) { out.balls.push({ at: m.at, radius: (m.radius ?? 6) * u, colour: m.colour }); continue; }
    if (!isPoint(m.from) || !isPoint(m.to)) continue;
    out.lines.push({ a: m.from, b: m.to, colour: m.colour, width: m.width ?? 2, dash: 0 });
    const d = sub(m.to, m.from), length = norm(d);
    if (m.tip !== false && length > 1e-9)
      out.cones.push({ at: m.to, direction: unit(d), length: Math.min(18 * u, 0.5 * length),
                       radius: Math.min(6 * u, 0.17 * length), colour: m.colour });
  }
  return out;
}

export function joined(all) {
  const out = { rods: [], boxes: [], cones: [], balls: [], lines: [], names: [] };
  for (const shapes of all) for (const kind in out) out[kind].push(...shapes[kind]);
  return out;
}
