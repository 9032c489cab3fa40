// Paints shapes on a flat canvas, back to front: where there is no WebGL, and for small pictures.
import { add, cross, dot, sub, times } from "./linkage.js";

const faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];

function shade(colour, light) {
  const n = parseInt(colour.slice(1), 16), k = 0.72 + 0.28 * light;
  return `rgb(${[16, 8, 0].map(s => Math.round((n >> s & 255) * k)).join(",")})`;
}

export function paint(context, camera, shapes, colours, { names = false, lit = null } = {}) {
  const { towards } = camera.basis(), todo = [];
  const flat = p => camera.project(p);
  const push = (depth, draw) => todo.push({ depth, draw });
  const stroke = (a, b, colour, width, dash = []) => {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.setLineDash(dash);
    context.beginPath();
    context.moveTo(a[0], a[1]);
    context.lineTo(b[0], b[1]);
    context.stroke();
  };
  for (const s of shapes.lines) {
    const a = flat(s.a), b = flat(s.b);
    push(Math.max(a[2], b[2]) + 1e-3, () => stroke(a, b, s.colour, s.width, s.dash ? [6, 4] : []));
  }
  for (const s of shapes.rods) {
    const a = flat(s.a), b = flat(s.b), colour = lit && s.key === lit ? colours.lit : s.colour;
    const width = Math.max(2, 2 * s.radius * camera.scale);
    push((a[2] + b[2]) / 2, () => {
      stroke(a, b, shade(colour, -1.2), width + 1.4);
      stroke(a, b, colour, width);
    });
  }
  for (const s of shapes.balls) {
    const a = flat(s.at);
    push(a[2] + s.radius, () => {
      context.fillStyle = s.colour;
      context.beginPath();
      context.arc(a[0], a[1], Math.max(2, s.radius * camera.scale), 0, 7);
      context.fill();
    });
  }
  const polygon = (points, fill, edge) => {
    context.beginPath();
    points.forEach((p, i) => i ? context.lineTo(p[0], p[1]) : context.moveTo(p[0], p[1]));
    context.closePath();
    context.fillStyle = fill;
    context.fill();
    if (edge) { context.strokeStyle = edge; context.lineWidth = 1; context.setLineDash([]); context.stroke(); }
  };
  for (const s of shapes.cones) {
    const back = sub(s.at, times(s.length, s.direction)), side = cross(s.direction, towards);
    const r = times(s.radius, side);
    push(flat(s.at)[2], () => polygon([s.at, add(back, r), sub(back, r)].map(flat), s.colour));
  }
  for (const s of shapes.boxes) {
    for (const face of faces) {
      const [a, b, c] = face.map(i => s.corners[i]);
      const normal = cross(sub(b, a), sub(c, b)), facing = dot(normal, towards) / Math.hypot(...normal);
      if (facing <= 0) continue;
      const corners = face.map(i => flat(s.corners[i]));
      push(corners.reduce((sum, p) => sum + p[2], 0) / 4, () => {
        context.globalAlpha = s.solid ? 1 : 0.5;
        polygon(corners, shade(lit && s.key === lit ? colours.lit : s.colour, facing), colours.faint);
        context.globalAlpha = 1;
      });
    }
  }
  todo.sort((a, b) => a.depth - b.depth);
  context.lineCap = "butt";
  for (const { draw } of todo) draw();
  context.setLineDash([]);
  if (names) for (const s of shapes.names) {
    if (s.kind === "axis") continue;
    const p = flat(s.at);
    context.font = "11px sans-serif";
    context.fillStyle = s.colour;
    context.fillText(s.text, p[0] + 3, p[1] - 3);
  }
}

// A painter as webgl.js makes one.
export function canvasPainter(element) {
  const canvas = document.createElement("canvas");
  element.append(canvas);
  const context = canvas.getContext("2d");
  return {
    kind: "canvas", canvas,
    resize(width, height) {
      const ratio = globalThis.devicePixelRatio || 1;
      canvas.width = width * ratio;
      canvas.height = height * ratio;
      canvas.style.width = width + "px";
      canvas.style.height = height + "px";
    },
    paint(camera, shapes, colours, lit) {
      const ratio = globalThis.devicePixelRatio || 1;
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.fillStyle = colours.paper;
      context.fillRect(0, 0, camera.width, camera.height);
      paint(context, camera, shapes, colours, { lit });
    },
    dispose() { canvas.remove(); },
  };
}
