// What a linkage's numbers mean: from coordinates to the flat list of values that the emitted
// function yields, and from there to frames, axes and points. The description's shape is told at
// the top of viewer.js. Points are [x, y, z] in mm in the root frame.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const times = (k, a) => [k * a[0], k * a[1], k * a[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const norm = a => Math.sqrt(dot(a, a));
export const unit = a => times(1 / (norm(a) || 1), a);
export const isPoint = a => a.every(Number.isFinite);

export const point = (values, at) => [values[at], values[at + 1], values[at + 2]];
export const origin = (values, at) => [values[at + 3], values[at + 7], values[at + 11]];
export const column = (values, at, j) => [values[at + j], values[at + 4 + j], values[at + 8 + j]];
export const turned = (values, at, v) => add(add(times(v[0], column(values, at, 0)),
  times(v[1], column(values, at, 1))), times(v[2], column(values, at, 2)));
export const placed = (values, at, p) => add(origin(values, at), turned(values, at, p));

// The slots' values where `coordinates` (in the units of the description) are set in `base`.
export function slotsAt(scene, coordinates, base = scene.base) {
  const slots = Float64Array.from(base);
  scene.coordinates.forEach((c, i) => {
    if (Number.isFinite(coordinates[i])) slots[c.slot] = coordinates[i] * c.factor;
  });
  return slots;
}

export function valuesAt(scene, coordinates, base = scene.base) {
  const out = new Float64Array(scene.size);
  scene.evaluate(slotsAt(scene, coordinates, base), out);
  return out;
}

export const atRest = scene => scene.coordinates.map(c => c.rest);

// The line of a joint's axis, its sense that of the growing coordinate; where nothing moves, null.
export function axisLine(scene, values, axis) {
  const parent = scene.frames[axis.frame].parent;
  const at = parent < 0 ? null : scene.frames[parent].at;
  const turn = point(values, axis.turn), slide = point(values, axis.slide);
  const turns = norm(turn) > 1e-9, along = turns ? turn : slide;
  if (!(norm(along) > 1e-12) || !isPoint(along)) return null;
  const direction = unit(at === null ? along : turned(values, at, along));
  let through = origin(values, scene.frames[axis.frame].at);
  if (turns) {
    const foot = times(1 / dot(turn, turn), cross(turn, slide));
    through = at === null ? foot : placed(values, at, foot);
  }
  // The middle of the joint: where its motion begins, moved onto the axis.
  const begins = point(values, axis.centre), off = sub(begins, through);
  const centre = turns ? add(through, times(dot(off, direction), direction)) : begins;
  return { turns, point: through, direction, centre };
}

// Angle (rad, 0 to pi/2), distance (mm) and the nearest points of two lines.
export function apart(a, b) {
  const normal = cross(a.direction, b.direction), sine = norm(normal);
  const between = sub(b.point, a.point), cosine = dot(a.direction, b.direction);
  const angle = Math.atan2(sine, Math.abs(cosine));
  if (sine < 1e-9) {
    const from = a.centre, along = dot(sub(from, b.point), b.direction);
    const to = add(b.point, times(along, b.direction));
    return { angle, distance: norm(sub(to, from)), from, to };
  }
  const s = dot(cross(between, b.direction), normal) / (sine * sine);
  const t = dot(cross(between, a.direction), normal) / (sine * sine);
  return { angle, distance: Math.abs(dot(between, normal)) / sine,
           from: add(a.point, times(s, a.direction)), to: add(b.point, times(t, b.direction)) };
}

// Pairs of consecutive axes: [{first, second, angle, distance, from, to}], numbers of scene.axes.
export function consecutive(scene, values) {
  const lines = scene.axes.map(axis => axisLine(scene, values, axis)), pairs = [];
  scene.axes.forEach((axis, i) => {
    const a = lines[axis.before], b = lines[i];
    if (a && b) pairs.push({ first: axis.before, second: i, ...apart(a, b) });
  });
  return pairs;
}
