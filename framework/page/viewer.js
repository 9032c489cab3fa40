// A linkage to look at from all sides and to move: in WebGL, or on a flat canvas where there is
// none. Drag turns, shift-drag or two fingers move, the wheel scales; with the keyboard arrows turn,
// shift-arrows move, + and - scale, 0 fits.
//
//     const viewer = createViewer(element, scene);
//     viewer.update(coordinates);     // in the units and the order of scene.coordinates
//     viewer.dispose();
//
// A scene is plain data (made by framework/page/linkage.cpp) and one function:
//
//     { name, slots, size,
//       base: [value of each slot],                 internal units: parameters, and rest elsewhere
//       evaluate(slots, out),                       fills `out`, `size` numbers long; lengths in mm
//       length: {unit, factor}, angle: {unit, factor},      shown = internal / factor
//       coordinates: [{name, column, unit, factor, rest, low, high, limited, circumstance, slot}],
//       frames: [{name, label, parent, main, at}],  at: place in `out` of T_root_frame, the rows of a
//                                                   3 x 4 matrix, 12 numbers
//       axes: [{joint, frame, coordinates: [numbers], before, moves, met, turn, slide, centre}],
//                                                   places of 3 numbers each: turn and slide of the
//                                                   joint's motion seen from the frame before it, and
//                                                   where the motion begins; before: an axis or -1
//       bones: [{from, to, body, limbed, stem, far, points: [places of 3 numbers]}],
//       limbs: [{name, frame, body, centre, size}], in the frame, mm
//       features: [{name, tag, kind, in, frame, at}],       kind: frame, point, direction, scalar, nothing
//       equations: [{frame, parent, motions: [{kind, axis, text}]} | {reading, column, text}] }
//
// Where `out` comes from elsewhere, viewer.show(out) takes it as it is and `evaluate` is not needed.
import { Camera } from "./camera.js";
import { canvasPainter, paint } from "./canvas.js";
import { atRest, sub, valuesAt } from "./linkage.js";
import { palette } from "./palette.js";
import { extentOf, joined, markShapes, shapesOf } from "./shapes.js";
import { webglPainter } from "./webgl.js";

export const formats = scene => ({
  length: mm => `${significant(mm / scene.length.factor)} ${scene.length.unit}`,
  angle: rad => scene.angle.unit === "deg" ? `${significant(rad / scene.angle.factor)}°`
    : `${significant(rad / scene.angle.factor)} ${scene.angle.unit}`,
});
export const significant = (v, digits = 4) => Math.abs(v) < 1e-9 ? "0" : String(+v.toPrecision(digits));

// options: flat (no WebGL), show (see shapes.js), values (to begin with, where there is no evaluate).
export function createViewer(element, scene, options = {}) {
  element.classList.add("viewer");
  let painter;
  try {
    if (options.flat) throw new Error("asked for");
    painter = webglPainter(element);
  } catch {
    painter = canvasPainter(element);
  }
  const overlay = document.createElement("div");
  overlay.className = "names";
  overlay.setAttribute("aria-hidden", "true");
  element.append(overlay);
  element.tabIndex = 0;
  element.setAttribute("role", "img");
  element.setAttribute("aria-label",
    `The linkage ${scene.name}. Arrow keys turn it, shift and arrow keys move it, plus and minus scale it, 0 fits it.`);

  const camera = new Camera(), format = formats(scene);
  let values = options.values ?? valuesAt(scene, atRest(scene));
  let extent = extentOf(scene, values), show = { ...options.show };
  let ghosts = [], marks = [], lit = null, shapes = null, pending = 0, gone = false;
  let drawn = [];  // of the names: so that only what changed touches the page

  const settings = () => ({ size: extent.size, colours: palette(), format, show });
  function build() {
    const all = [shapesOf(scene, values, settings())];
    for (const g of ghosts) {
      const of = { size: extent.size, colours: palette(), show: { ...show, apart: false }, ghost: g.colour };
      all.push(shapesOf(g.scene ?? scene, g.values, of));
    }
    all.push(markShapes(marks, extent.size));
    shapes = joined(all);
  }
  function paintNow() {
    pending = 0;
    if (gone) return;
    if (!shapes) build();
    painter.paint(camera, shapes, palette(), lit);
    writeNames();
  }
  const redraw = () => { if (!pending && !gone) pending = requestAnimationFrame(paintNow); };
  const rebuild = () => { shapes = null; redraw(); };

  // Names keep off each other: each takes the first free side of its place, or is left out.
  function writeNames() {
    const taken = [], list = [], rank = { frame: 0, joint: 1, apart: 2, feature: 3, limb: 4, note: 5, axis: 6 };
    for (const n of [...shapes.names].sort((a, b) => rank[a.kind] - rank[b.kind])) {
      const w = 4 + n.text.length * (n.kind === "frame" ? 8 : 6.6), h = 15;
      let [x, y] = camera.project(n.at);
      if (n.kind === "note") {  // how far away what is not in the picture is
        x = Math.max(w / 2 + 4, Math.min(camera.width - w / 2 - 4, x));
        y = Math.max(h, Math.min(camera.height - h, y));
      }
      for (const [dx, dy] of [[0, 0], [0, -12], [0, 12], [w / 2 + 6, 0], [-w / 2 - 6, 0], [w / 2, -14], [-w / 2, 14]]) {
        const box = [x + dx - w / 2, y + dy - h / 2, x + dx + w / 2, y + dy + h / 2];
        if (taken.some(t => t[0] < box[2] && box[0] < t[2] && t[1] < box[3] && box[1] < t[3])) continue;
        taken.push(box);
        list.push({ x: Math.round(x + dx), y: Math.round(y + dy), n });
        break;
      }
    }
    while (drawn.length < list.length) {
      const span = document.createElement("span");
      overlay.append(span);
      drawn.push(span);
    }
    drawn.forEach((span, i) => {
      const item = list[i];
      span.hidden = !item;
      if (!item) return;
      if (span.textContent !== item.n.text) span.textContent = item.n.text;
      span.className = item.n.kind;
      span.style.color = lit && item.n.key === lit ? palette().lit : item.n.colour;
      span.style.transform = `translate(-50%,-50%) translate(${item.x}px,${item.y}px)`;
    });
  }

  function resize() {
    const width = element.clientWidth || 600, height = element.clientHeight || 400;
    const zoom = camera.scale / camera.fitted, target = camera.target;
    Object.assign(camera, { width, height });
    painter.resize(width, height);
    camera.fit(extent);
    if (Number.isFinite(zoom) && zoom !== 1) { camera.scale *= zoom; camera.target = target; }
    paintNow();
  }
  const observer = new ResizeObserver(resize);
  observer.observe(element);

  // Pointers.
  const pointers = new Map();
  let moved = 0;
  const on = (type, f, opts) => element.addEventListener(type, f, opts);
  on("pointerdown", e => {
    pointers.set(e.pointerId, [e.clientX, e.clientY]);
    moved = 0;
    element.setPointerCapture(e.pointerId);
  });
  on("pointermove", e => {
    const last = pointers.get(e.pointerId);
    if (!last) return;
    const dx = e.clientX - last[0], dy = e.clientY - last[1];
    moved += Math.abs(dx) + Math.abs(dy);
    if (pointers.size > 1) {
      const [a, b] = [...pointers.values()], before = Math.hypot(a[0] - b[0], a[1] - b[1]);
      last[0] = e.clientX; last[1] = e.clientY;
      const after = Math.hypot(a[0] - b[0], a[1] - b[1]);
      camera.scale *= before > 0 ? after / before : 1;
      camera.pan(dx / 2, dy / 2);
    } else if (e.shiftKey || e.buttons & 6) { camera.pan(dx, dy); chosen = true; }
    else camera.orbit(dx * 0.008, dy * 0.008);
    pointers.set(e.pointerId, [e.clientX, e.clientY]);
    redraw();
  });
  const release = e => {
    if (pointers.delete(e.pointerId) && moved < 4 && e.type === "pointerup") pick(e);
  };
  on("pointerup", release);
  on("pointercancel", release);
  on("contextmenu", e => e.preventDefault());
  on("wheel", e => {
    e.preventDefault();
    camera.scale *= Math.exp(-e.deltaY * 0.0012);
    chosen = true;
    redraw();
  }, { passive: false });
  on("keydown", e => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[e.key];
    if (step && e.shiftKey) camera.pan(-24 * step[0], -24 * step[1]);
    else if (step) camera.orbit(0.12 * step[0], -0.12 * step[1]);
    else if (e.key === "+" || e.key === "=") camera.scale *= 1.15;
    else if (e.key === "-") camera.scale /= 1.15;
    else if (e.key === "0") viewer.fit();
    else return;
    e.preventDefault();
    redraw();
  });
  function pick(e) {
    const box = element.getBoundingClientRect(), at = [e.clientX - box.left, e.clientY - box.top];
    let best = null, least = 14;
    const near = (a, b, key) => {
      if (!key) return;
      const p = camera.project(a), q = camera.project(b), d = [q[0] - p[0], q[1] - p[1]];
      const t = Math.max(0, Math.min(1, ((at[0] - p[0]) * d[0] + (at[1] - p[1]) * d[1]) / (d[0] ** 2 + d[1] ** 2 || 1)));
      const away = Math.hypot(at[0] - p[0] - t * d[0], at[1] - p[1] - t * d[1]) - (key.startsWith("joint") ? 4 : 0);
      if (away < least) { least = away; best = key; }
    };
    for (const s of shapes.rods) near(s.a, s.b, s.key);
    for (const s of shapes.lines) near(s.a, s.b, s.key);
    for (const s of shapes.boxes) near(sub(s.corners[0], [0, 0, 0]), s.corners[7], s.key);
    viewer.onpick?.(best);
  }

  const themes = ["(prefers-color-scheme: dark)", "print"].map(query => matchMedia(query));
  const themed = () => { shapes = null; if (!gone) paintNow(); };
  for (const query of themes) query.addEventListener("change", themed);

  // Where the posture leaves the view, the view grows, unless somebody has chosen a part of it.
  let chosen = false;
  const united = all => ({ low: [0, 1, 2].map(i => Math.min(...all.map(e => e.low[i]))),
    high: [0, 1, 2].map(i => Math.max(...all.map(e => e.high[i]))), size: extent.size,
    points: all.flatMap(e => e.points).slice(-20000) });
  function makeRoom() {
    if (chosen) return;
    const now = extentOf(scene, values);
    const outside = now.points.some(p => {
      const [x, y] = camera.project(p);
      return x < 8 || y < 8 || x > camera.width - 8 || y > camera.height - 8;
    });
    if (!outside) return;
    extent = united([extent, now]);
    camera.fit(extent);
  }

  const viewer = {
    kind: painter.kind,
    onpick: null,
    get values() { return values; },
    update(coordinates, base) { viewer.show(valuesAt(scene, coordinates, base)); },
    show(out) { values = out; makeRoom(); rebuild(); },
    // Another linkage in the same view.
    scene(other, out) { scene = other; values = out ?? valuesAt(scene, atRest(scene)); rebuild(); },
    // [{values, colour, scene}]: further linkages in thin lines; scene where it is another's.
    ghosts(list) { ghosts = list; rebuild(); },
    // [{from, to, colour, tip} | {at, colour}] in mm in the root frame.
    marks(list) { marks = list; rebuild(); },
    visible(parts) { show = { ...show, ...parts }; rebuild(); },
    highlight(key) { lit = key; redraw(); },
    up(axis) { camera.up = axis; camera.fit(extent); redraw(); },
    from(azimuth, elevation) { camera.azimuth = azimuth; camera.elevation = elevation; camera.fit(extent); redraw(); },
    // Makes room for all of these postures.
    frame(list) {
      extent = united(list.map(v => extentOf(scene, v)));
      chosen = false;
      camera.fit(extent);
      rebuild();
    },
    fit() { extent = { ...extentOf(scene, values), size: extent.size }; chosen = false; camera.fit(extent); redraw(); },
    // A small picture of another posture, seen from the same side.
    snapshot(canvas, of, extra = []) {
      const small = new Camera(), colours = palette();
      Object.assign(small, { up: camera.up, azimuth: camera.azimuth, elevation: camera.elevation,
                             width: canvas.width, height: canvas.height });
      small.fit(extentOf(scene, of));
      const context = canvas.getContext("2d");
      context.fillStyle = colours.paper;
      context.fillRect(0, 0, canvas.width, canvas.height);
      const list = [shapesOf(scene, of, { size: 1.3 * extentOf(scene, of).size, colours, show: { names: false } }), ...extra];
      paint(context, small, joined(list), colours);
    },
    project: point => camera.project(point),  // pixels from the upper left corner, and how near
    paint: paintNow,
    dispose() {
      gone = true;
      cancelAnimationFrame(pending);
      observer.disconnect();
      for (const query of themes) query.removeEventListener("change", themed);
      painter.dispose();
      overlay.remove();
    },
  };
  resize();
  return viewer;
}
