// What charts of both pages are made of: axes, markers that are told apart by shape as well as by
// colour, a band about zero, a legend that shows values only where there are some.
import uPlot from "uplot";
import { number } from "./dom.js";
import { palette } from "./palette.js";

export const rms = list => {
  const known = list.filter(v => v !== null && v !== undefined);
  return known.length ? Math.sqrt(known.reduce((sum, v) => sum + v * v, 0) / known.length) : null;
};
export const named = (name, unit) => unit ? `${name} (${unit})` : name;

// Draws anew when the width, the colours or what is chosen change.
export function holder(element, make) {
  let chart = null, width = 0;
  const redraw = () => {
    chart?.destroy();
    chart = make(Math.max(260, element.clientWidth || 640));
  };
  new ResizeObserver(() => {
    if (element.clientWidth && element.clientWidth !== width) { width = element.clientWidth; redraw(); }
  }).observe(element);
  for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", redraw);
  return { redraw, get chart() { return chart; } };
}

// A label keeps to `room` pixels.
const axis = (colours, label, size, room) => ({ label, size, stroke: colours.ink, labelSize: 24, labelGap: 2,
  font: "12px system-ui, sans-serif", labelFont: `${Math.min(13, Math.floor(room / (0.56 * label.length)))}px system-ui, sans-serif`, grid: { stroke: colours.rule, width: 1 },
  ticks: { stroke: colours.rule, width: 1, size: 5 }, values: (u, list) => list.map(v => v === null ? "" : number(v, 6)) });

// Within the chart's own area, in its colours.
export function within(u, draw, margin = 0) {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left - margin, bbox.top - margin, bbox.width + 2 * margin, bbox.height + 2 * margin);
  ctx.clip();
  draw(ctx, bbox);
  ctx.restore();
}

// Path functions of uPlot. shape: circle, square, cross; filled; bars: half lengths, or none.
export function marker(shape, colour, filled, bars = null) {
  return (u, i, from, to) => {
    const [xs, ys] = [u.data[0], u.data[i]], r = 3.5 * devicePixelRatio;
    within(u, ctx => {
      ctx.strokeStyle = ctx.fillStyle = colour;
      for (let k = from; k <= to; ++k) {
        if (ys[k] === null || ys[k] === undefined) continue;
        const x = u.valToPos(xs[k], "x", true), y = u.valToPos(ys[k], "y", true);
        if (bars?.[k] > 0) {
          ctx.lineWidth = devicePixelRatio;
          ctx.globalAlpha = 0.6;
          ctx.beginPath();
          ctx.moveTo(x, u.valToPos(ys[k] - bars[k], "y", true));
          ctx.lineTo(x, u.valToPos(ys[k] + bars[k], "y", true));
          ctx.stroke();
          ctx.globalAlpha = 1;
        }
        ctx.lineWidth = 1.4 * devicePixelRatio;
        ctx.beginPath();
        if (shape === "square") ctx.rect(x - r, y - r, 2 * r, 2 * r);
        else if (shape === "cross") { ctx.moveTo(x - r, y); ctx.lineTo(x + r, y); ctx.moveTo(x, y - r); ctx.lineTo(x, y + r); }
        else ctx.arc(x, y, r, 0, 7);
        filled && shape !== "cross" ? ctx.fill() : ctx.stroke();
      }
    }, r);
    return null;
  };
}

// A series of points, and what it looks like in the legend.
export const points = (label, colour, shape, filled, bars = null) => ({ label, stroke: colour, fill: filled ? colour : "transparent",
  class: shape, paths: marker(shape, colour, filled, bars), points: { show: false }, value: (u, v) => number(v, 4) });

// A line with a band, `bands` to either side of it.
export const banded = (label, colour, bands) => ({ label, stroke: colour, fill: colour, class: "line", width: 2, points: { show: false }, value: (u, v) => number(v, 3),
  paths: (u, i, from, to) => {
    const [xs, ys] = [u.data[0], u.data[i]], list = [];
    for (let k = from; k <= to; ++k) if (ys[k] !== null && ys[k] !== undefined) list.push(k);
    const at = (k, off) => [u.valToPos(xs[k], "x", true), u.valToPos(ys[k] + off, "y", true)];
    within(u, ctx => {
      ctx.fillStyle = ctx.strokeStyle = colour;
      ctx.beginPath();
      for (const k of list) ctx.lineTo(...at(k, bands[k] ?? 0));
      for (const k of [...list].reverse()) ctx.lineTo(...at(k, -(bands[k] ?? 0)));
      ctx.globalAlpha = 0.25;
      ctx.fill();
      ctx.globalAlpha = 1;
      ctx.lineWidth = 2 * devicePixelRatio;
      ctx.beginPath();
      for (const k of list) ctx.lineTo(...at(k, 0));
      ctx.stroke();
    });
    return null;
  } });

// options: width, height, x, y: labels of the axes; series: as points() and banded() make them, with
// `ys`; band: half width about zero; chosen(): number of the point that is marked, or -1;
// onpoint(k); zoom: drag enlarges.
export function plot(box, xs, options) {
  const colours = palette(), columns = [xs, ...options.series.map(s => s.ys)], chosen = options.chosen ?? (() => -1);
  const quiet = u => {  // under the cursor, else of what is chosen, else nothing
    const away = !(u.cursor.left >= 0), at = chosen();
    if (away && at >= 0) u.setLegend({ idx: at }, false);
    u.root.classList.toggle("idle", away && at < 0);
  };
  const nearest = u => {
    let best = -1, least = 900;
    for (const list of columns.slice(1)) list.forEach((v, k) => {
      if (v === null || v === undefined) return;
      const d = (u.valToPos(xs[k], "x") - u.cursor.left) ** 2 + (u.valToPos(v, "y") - u.cursor.top) ** 2;
      if (d < least) { least = d; best = k; }
    });
    return best;
  };
  const made = new uPlot({
    width: options.width, height: options.height, scales: { x: { time: false } },
    series: [{ label: options.x, value: (u, v) => number(v, 5) }, ...options.series],
    axes: [axis(colours, options.x, 34, options.width - 90), axis(colours, options.y, 62, options.height - 64)],
    legend: { live: true, markers: { width: 1.4, stroke: (u, i) => options.series[i - 1].stroke, fill: (u, i) => options.series[i - 1].fill } },
    cursor: { points: { show: false }, drag: options.zoom ? { x: true, y: true, uni: 20 } : { x: false, y: false }, focus: { prox: 30 } },
    hooks: {
      drawAxes: [u => within(u, (ctx, bbox) => {
        const at = v => u.valToPos(v, "y", true);
        if (options.band) {
          ctx.fillStyle = colours.rule;
          ctx.globalAlpha = 0.45;
          ctx.fillRect(bbox.left, at(options.band), bbox.width, at(-options.band) - at(options.band));
          ctx.globalAlpha = 1;
        }
        ctx.strokeStyle = colours.faint;
        ctx.beginPath();
        ctx.moveTo(bbox.left, at(0));
        ctx.lineTo(bbox.left + bbox.width, at(0));
        ctx.stroke();
      })],
      draw: [u => {
        const k = chosen();
        if (k < 0) return;
        within(u, (ctx, bbox) => {
          const x = u.valToPos(xs[k], "x", true), r = 8 * devicePixelRatio;
          ctx.strokeStyle = colours.lit;
          ctx.lineWidth = 1.5 * devicePixelRatio;
          ctx.beginPath();
          ctx.moveTo(x, bbox.top);
          ctx.lineTo(x, bbox.top + bbox.height);
          for (const list of columns.slice(1))
            if (list[k] !== null && list[k] !== undefined) {
              const y = u.valToPos(list[k], "y", true);
              ctx.moveTo(x + r, y);
              ctx.arc(x, y, r, 0, 7);
            }
          ctx.stroke();
        }, 8 * devicePixelRatio);
      }],
      setCursor: [quiet],
      ready: [quiet, u => u.over.addEventListener("click", () => {
        const k = options.onpoint ? nearest(u) : -1;
        if (k >= 0) options.onpoint(k);
      })],
    },
  }, columns, box);
  // Only what is marked has changed.
  made.mark = () => { quiet(made); made.redraw(false); };
  return made;
}
