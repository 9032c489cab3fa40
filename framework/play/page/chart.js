// Residuals of one measure against a coordinate: of the model as it stands and, where the solver
// has been asked, with its answer.
import uPlot from "uplot";
import { h, number, unitText } from "../../page/dom.js";
import { palette } from "../../page/palette.js";

// Told apart by shape as well as by colour.
const points = (shape, colour) => (u, i, from, to) => {
  const { ctx } = u, xs = u.data[0], ys = u.data[i], r = 3.2 * devicePixelRatio;
  ctx.save();
  ctx.strokeStyle = ctx.fillStyle = colour;
  ctx.lineWidth = 1.4 * devicePixelRatio;
  for (let k = from; k <= to; ++k) {
    if (ys[k] === null || ys[k] === undefined) continue;
    const x = u.valToPos(xs[k], "x", true), y = u.valToPos(ys[k], "y", true);
    ctx.beginPath();
    if (shape === "square") ctx.rect(x - r, y - r, 2 * r, 2 * r);
    else ctx.arc(x, y, r, 0, 7);
    shape === "square" ? ctx.fill() : ctx.stroke();
  }
  ctx.restore();
  return null;
};
const rms = list => {
  const known = list.filter(v => v !== null);
  return known.length ? Math.sqrt(known.reduce((sum, v) => sum + v * v, 0) / known.length) : null;
};

export function residualChart(onpose) {
  let states = [], scene = null, chart = null, width = 0;
  const box = h("div", { class: "chart", role: "img", tabindex: 0 }), words = h("p", { class: "note" });
  const measure = h("select", { "aria-label": "residual of", onchange: () => draw() });
  const against = h("select", { "aria-label": "against", onchange: () => draw() });
  const element = h("div", { hidden: true }, h("div", { class: "tools" }, h("label", {}, "Residuals (measured − modelled) of ", measure), h("label", {}, "against ", against)), box, words);

  function options(select, names) {
    const before = select.value;
    if ([...select.options].map(o => o.value).join() === names.join()) return;
    select.replaceChildren(...names.map(n => h("option", { value: n }, n)));
    if (names.includes(before)) select.value = before;
  }
  function draw() {
    chart?.destroy();
    chart = null;
    const first = states[0];
    if (!first) { box.replaceChildren(); words.textContent = ""; return; }
    const row = first.rows.find(r => r.name === measure.value) ?? first.rows[0];
    const at = scene.coordinates.findIndex(c => c.name === against.value), coordinate = scene.coordinates[at];
    const values = at < 0 ? row.residuals.map((_, k) => k + 1) : first.coordinates[at];
    const order = values.map((_, k) => k).filter(k => values[k] !== null).sort((a, b) => values[a] - values[b]);
    const xs = order.map(k => values[k]), colours = palette(), unit = unitText(row.unit);
    const series = [{ label: at < 0 ? "pose" : coordinate.name }], columns = [xs];
    states.forEach((state, i) => {
      const residuals = state.rows.find(r => r.name === row.name)?.residuals;
      if (!residuals) return;
      const colour = i ? colours.after : colours.before;
      series.push({ label: state.label, stroke: colour, paths: points(i ? "square" : "circle", colour), points: { show: false }, value: (u, v) => number(v, 4) });
      columns.push(order.map(k => residuals[k]));
    });
    const axis = (label, size) => ({ label, size, labelSize: 22, stroke: colours.ink, font: "12px system-ui, sans-serif", labelFont: "13px system-ui, sans-serif",
      grid: { stroke: colours.rule, width: 1 }, ticks: { stroke: colours.rule, width: 1, size: 4 }, values: (u, list) => list.map(v => number(v, 6)) });
    chart = new uPlot({ width: Math.max(260, width), height: 240, series, scales: { x: { time: false } }, legend: { live: false },
      cursor: { points: { show: false }, drag: { x: false, y: false } },
      axes: [axis(at < 0 ? "pose" : `${coordinate.name}${unitText(coordinate.unit) ? ` (${coordinate.unit})` : ""}`, 34),
        axis(`${row.name}${unit ? ` (${unit})` : ""}`, 58)],
      hooks: { drawAxes: [u => {
        const { ctx } = u, y0 = u.valToPos(0, "y", true);
        ctx.save();
        if (row.sigma) {
          ctx.beginPath();
          ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
          ctx.clip();
          const a = u.valToPos(row.sigma, "y", true), b = u.valToPos(-row.sigma, "y", true);
          ctx.fillStyle = colours.rule;
          ctx.globalAlpha = 0.5;
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
      ready: [u => u.over.addEventListener("click", () => {
        let best = -1, least = 900;
        for (const list of columns.slice(1)) list.forEach((v, k) => {
          if (v === null) return;
          const d = (u.valToPos(xs[k], "x") - u.cursor.left) ** 2 + (u.valToPos(v, "y") - u.cursor.top) ** 2;
          if (d < least) { least = d; best = k; }
        });
        if (best >= 0) onpose(scene.coordinates.map((_, i) => first.coordinates[i]?.[order[best]] ?? null));
      })] } }, columns, box);
    words.textContent = `Root mean square of ${row.name}: ${states.map(s =>
      `${number(rms(s.rows.find(r => r.name === row.name)?.residuals ?? []), 3)}${unit ? " " + unit : ""} (${s.label})`).join(", ")}.`
      + (row.sigma ? " The band is one stated sigma of the measurement. Choose a point to see its pose." : " Choose a point to see its pose.");
    box.setAttribute("aria-label", `Residuals of ${row.name} against ${series[0].label}. ${words.textContent}`);
  }
  new ResizeObserver(() => {
    if (box.clientWidth && box.clientWidth !== width) { width = box.clientWidth; draw(); }
  }).observe(box);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  return {
    element,
    get states() { return states; },
    // The states as in a report's page; the first is that of the model as it stands.
    show(list, of) {
      states = list.filter(Boolean);
      scene = of;
      if (states.length) {
        options(measure, states[0].rows.map(r => r.name));
        options(against, ["pose", ...scene.coordinates.filter((c, i) => new Set(states[0].coordinates[i]).size > 1).map(c => c.name)]);
      }
      element.hidden = !states.length;
      draw();
    },
    choose(m, a) {
      if ([...measure.options].some(o => o.value === m)) measure.value = m;
      if ([...against.options].some(o => o.value === a)) against.value = a;
      draw();
    },
  };
}
