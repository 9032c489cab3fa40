// Charts of residuals and of fitted effects. A point chosen in a chart is the pose shown in the
// picture, and the other way round.
import uPlot from "uplot";
import { h, number, unitText } from "./dom.js";
import { palette } from "./palette.js";

// Draws anew when its width, the colours or what is chosen change.
function holder(element, make) {
  let chart = null, width = 0;
  const redraw = () => {
    chart?.destroy();
    chart = make(element.clientWidth || 640);
  };
  const observer = new ResizeObserver(() => {
    if (element.clientWidth !== width) { width = element.clientWidth; redraw(); }
  });
  observer.observe(element);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  matchMedia("print").addEventListener("change", redraw);
  return { redraw, get chart() { return chart; } };
}

const axis = (colours, label, extra = {}) => ({ label, stroke: colours.ink, labelSize: 24, labelGap: 2, size: 46, font: "12px system-ui, sans-serif",
  labelFont: "13px system-ui, sans-serif", grid: { stroke: colours.rule, width: 1 }, ticks: { stroke: colours.rule, width: 1, size: 5 },
  values: (u, list) => list.map(v => v === null ? "" : number(v, 6)), ...extra });
const bottom = (colours, label) => axis(colours, label, { size: 34 });
const left = (colours, label) => axis(colours, label, { size: 62 });

// Told apart by shape as well as by colour.
function marker(shape, colour, filled, size = 7) {
  return (u, i, from, to) => {
    const { ctx } = u, [xs, ys] = [u.data[0], u.data[i]], r = size / 2 * devicePixelRatio;
    ctx.save();
    ctx.beginPath();
    ctx.rect(u.bbox.left - r, u.bbox.top - r, u.bbox.width + 2 * r, u.bbox.height + 2 * r);
    ctx.clip();
    ctx.strokeStyle = ctx.fillStyle = colour;
    ctx.lineWidth = 1.4 * devicePixelRatio;
    for (let k = from; k <= to; ++k) {
      if (ys[k] === null || ys[k] === undefined) continue;
      const x = u.valToPos(xs[k], "x", true), y = u.valToPos(ys[k], "y", true);
      ctx.beginPath();
      if (shape === "square") ctx.rect(x - r, y - r, 2 * r, 2 * r);
      else if (shape === "cross") { ctx.moveTo(x - r, y); ctx.lineTo(x + r, y); ctx.moveTo(x, y - r); ctx.lineTo(x, y + r); }
      else ctx.arc(x, y, r, 0, 7);
      filled && shape !== "cross" ? ctx.fill() : ctx.stroke();
    }
    ctx.restore();
    return null;
  };
}

// Which numbers of a pose residuals can be drawn against.
export function covariates(store) {
  const { data } = store, list = [{ name: "row", unit: "", values: null }];
  const taken = new Set(["row"]);
  for (const c of data.columns) {
    const distinct = new Set(c.values.filter(v => v !== null));
    if (distinct.size > 1 && !taken.has(c.name)) { list.push(c); taken.add(c.name); }
  }
  const state = store.withPoses();
  if (state) store.sceneOf(state).coordinates.forEach((c, i) => {
    const values = state.coordinates[i];
    if (values && !taken.has(c.name) && !taken.has(c.column) && !c.column.includes(":") && new Set(values).size > 1)
      list.push({ name: c.name, unit: c.unit, values });
  });
  return list;
}

export function residualChart(store) {
  const { data } = store;
  const judged = data.states.map((s, i) => ({ s, i })).filter(({ s }) => s.rows.some(r => r.residuals));
  if (!judged.length) return null;
  // Before and after: the last two states with residuals; a single one stands alone.
  // Of `axes` the states are different recordings, of which the first is shown.
  const [before, after] = judged.length > 1 && data.command !== "axes" ? judged.slice(-2).map(j => j.s) : [null, judged.at(-1).s];
  const measures = after.rows.filter(r => r.residuals?.some(v => v !== null));
  if (!measures.length) return null;
  const against = covariates(store), box = h("div", { class: "chart", id: "residuals", tabindex: 0, role: "img" });
  const count = after.rows.find(r => r.residuals).residuals.length;
  let measure = measures[0].name, x = against[0], what = before && before.label !== "nominal" ? "both" : "after", order = [], xs = [];
  const summary = h("p", { class: "note", "aria-live": "polite" });

  function columnsOf() {
    order = Array.from({ length: count }, (_, k) => k).filter(k => !x.values || x.values[k] !== null);
    const at = k => x.values ? x.values[k] : k + 1;
    order.sort((a, b) => at(a) - at(b) || a - b);
    xs = order.map(at);
    const of = state => state?.rows.find(r => r.name === measure)?.residuals ?? [];
    const pick = (list, use) => order.map(k => (data.use[k] === "c") === use ? list[k] ?? null : null);
    const colours = palette(), series = [{ label: x.name + (unitText(x.unit) ? ` (${x.unit})` : "") }], columns = [xs];
    const put = (label, list, colour, shape, filled) => {
      if (!list.some(v => v !== null)) return;
      series.push({ label, stroke: colour, fill: colour, paths: marker(shape, colour, filled), points: { show: false },
                    value: (u, v) => number(v, 4) });
      columns.push(list);
    };
    const split = data.use.includes("c"), name = s => s.label;
    if (before && what !== "after" && what !== "taken") {
      put(split ? `${name(before)}, fitted rows` : name(before), pick(of(before), false), colours.before, "circle", false);
      put(`${name(before)}, held out`, pick(of(before), true), colours.before, "square", false);
    }
    if (what !== "before" && what !== "taken") {
      put(split ? `${name(after)}, fitted rows` : name(after), pick(of(after), false), colours.after, "circle", true);
      put(`${name(after)}, held out`, pick(of(after), true), colours.heldout, "square", true);
    }
    if (before && (what === "taken" || what === "over")) {
      const b = of(before), a = of(after);
      put("taken away: what the change of model explains", order.map(k => b[k] === null || a[k] === null || b[k] === undefined || a[k] === undefined ? null : b[k] - a[k]),
          colours.effect, "cross", false);
    }
    return { series, columns };
  }
  const chart = holder(box, width => {
    const colours = palette(), { series, columns } = columnsOf(), row = after.rows.find(r => r.name === measure);
    const unit = unitText(row.unit);
    const sigma = row.sigma;
    const made = new uPlot({
      width, height: 300, series, legend: { live: true }, scales: { x: { time: false } },
      axes: [bottom(colours, series[0].label), left(colours, `${measure}, measured − modelled${unit ? ` (${unit})` : ""}`)],
      cursor: { points: { show: false }, drag: { x: true, y: true, uni: 20 }, focus: { prox: 30 } },
      hooks: {
        drawAxes: [u => {  // one stated sigma to either side of zero
          const { ctx } = u, y0 = u.valToPos(0, "y", true);
          ctx.save();
          ctx.beginPath();
          ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
          ctx.clip();
          if (sigma) {
            const a = u.valToPos(sigma, "y", true), b = u.valToPos(-sigma, "y", true);
            ctx.fillStyle = colours.rule;
            ctx.globalAlpha = 0.45;
            ctx.fillRect(u.bbox.left, a, u.bbox.width, b - a);
            ctx.globalAlpha = 1;
          }
          ctx.strokeStyle = colours.faint;
          ctx.beginPath();
          ctx.moveTo(u.bbox.left, y0);
          ctx.lineTo(u.bbox.left + u.bbox.width, y0);
          ctx.stroke();
          ctx.restore();
        }],
        draw: [u => {
          const at = order.indexOf(store.pose);
          if (at < 0) return;
          const { ctx } = u, px = u.valToPos(xs[at], "x", true);
          ctx.save();
          ctx.strokeStyle = colours.lit;
          ctx.lineWidth = 1.5 * devicePixelRatio;
          ctx.beginPath();
          ctx.moveTo(px, u.bbox.top);
          ctx.lineTo(px, u.bbox.top + u.bbox.height);
          for (const list of columns.slice(1))
            if (list[at] !== null) {
              const y = u.valToPos(list[at], "y", true), r = 8 * devicePixelRatio;
              ctx.moveTo(px + r, y);
              ctx.arc(px, y, r, 0, 7);
            }
          ctx.stroke();
          ctx.restore();
        }],
        ready: [u => u.over.addEventListener("click", () => {
          const at = nearest(u, columns);
          if (at >= 0) store.setPose(order[at]);
        })],
      },
    }, columns, box);
    const rms = list => {
      const known = list.filter(v => v !== null && v !== undefined);
      return Math.sqrt(known.reduce((sum, v) => sum + v * v, 0) / known.length);
    };
    const of = (state, c) => rms((state.rows.find(r => r.name === measure)?.residuals ?? []).filter((_, k) => c === null || (data.use[k] === "c") === c));
    const words = [];
    for (const s of [before, after].filter(Boolean))
      words.push(data.use.includes("c") ? `${s.label}: ${number(of(s, true), 3)} held out, ${number(of(s, false), 3)} fitted` : `${s.label}: ${number(of(s, null), 3)}`);
    summary.textContent = `Root mean square of ${measure}${unit ? ` in ${unit}` : ""}: ${words.join("; ")}.${sigma ? " The band is one stated sigma of what is measured." : ""}`;
    box.setAttribute("aria-label", `Residuals of ${measure} against ${x.name}. ${summary.textContent} Left and right arrows choose a pose.`);
    return made;
  });
  function nearest(u, columns) {
    const { left: cx, top: cy } = u.cursor;
    let best = -1, least = 900;
    for (const list of columns.slice(1)) list.forEach((v, k) => {
      if (v === null) return;
      const d = (u.valToPos(xs[k], "x") - cx) ** 2 + (u.valToPos(v, "y") - cy) ** 2;
      if (d < least) { least = d; best = k; }
    });
    return best;
  }
  box.addEventListener("keydown", e => {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[e.key];
    if (!by) return;
    e.preventDefault();
    const at = order.indexOf(store.pose);
    store.setPose(order[Math.max(0, Math.min(order.length - 1, at < 0 ? 0 : at + by))]);
  });
  store.on("pose", () => chart.chart?.redraw(false));
  const choose = (label, options, f, id) => h("label", {}, label, " ", h("select", { id, onchange: e => { f(e.target.value); chart.redraw(); } },
    options.map(([value, text]) => h("option", { value, selected: value === what }, text))));
  const tools = h("div", { class: "tools" },
    choose("of", measures.map(r => [r.name, r.name]), v => { measure = v; }, "measure"),
    choose("against", against.map((c, i) => [i, c.name]), v => { x = against[+v]; }, "against"),
    before ? choose("show", [["both", "before and after"], ["over", "before, after, what was taken away"], ["before", `before: ${before.label}`],
      ["after", `after: ${after.label}`], ["taken", "what was taken away"]], v => { what = v; }, "what") : null);
  return { element: h("div", {}, tools, box, summary), get chart() { return chart.chart; }, get data() { return columnsOf(); } };
}

// What the poses ask for at a finding's place, before and after, and the fitted effect.
export function curveChart(curve) {
  const box = h("div", { class: "chart", role: "img", "aria-label":
    `${curve.y} against ${curve.x}: ${curve.points.length} bins, before, after, and the fitted effect` });
  const xs = curve.points.map(p => p.x), bars = (list, colour, shape, filled) => (u, i, from, to) => {
    const { ctx } = u;
    ctx.save();
    ctx.strokeStyle = colour;
    ctx.lineWidth = devicePixelRatio;
    ctx.globalAlpha = 0.6;
    curve.points.forEach((p, k) => {
      if (p[list] === null || !(p.std > 0)) return;
      const x = u.valToPos(p.x, "x", true);
      ctx.beginPath();
      ctx.moveTo(x, u.valToPos(p[list] - p.std, "y", true));
      ctx.lineTo(x, u.valToPos(p[list] + p.std, "y", true));
      ctx.stroke();
    });
    ctx.restore();
    return marker(shape, colour, filled)(u, i, from, to);
  };
  holder(box, width => {
    const colours = palette(), unit = unitText(curve.unit);
    return new uPlot({
      width: Math.min(width, 760), height: 240, scales: { x: { time: false } },
      axes: [bottom(colours, `${curve.x}${unitText(curve.x_unit) ? ` (${curve.x_unit})` : ""}`), left(colours, `${curve.y}${unit ? ` (${unit})` : ""}`)],
      cursor: { points: { show: false }, drag: { x: false, y: false } },
      series: [{ label: curve.x, value: (u, v) => number(v, 4) },
        { label: "before", stroke: colours.before, paths: bars("before", colours.before, "circle", false), points: { show: false }, value: (u, v) => number(v, 3) },
        { label: "after", stroke: colours.after, paths: bars("after", colours.after, "square", true), points: { show: false }, value: (u, v) => number(v, 3) },
        { label: "fitted effect", stroke: colours.effect, width: 2, points: { show: false }, value: (u, v) => number(v, 3) }],
    }, [xs, ...["before", "after", "fitted"].map(n => curve.points.map(p => p[n]))], box);
  });
  return box;
}
