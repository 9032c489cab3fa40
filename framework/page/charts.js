// Residuals of one measure against any number of the pose, before and after a change of the model:
// the chart of the report and of the teaching page. A point chosen in it is the pose shown in the
// picture, and the other way round.
//
//     const chart = residualChart({ onpose: k => …, height, ids: {box, measure, against, what} });
//     chart.show({ before, after,       // states: {label, rows: [{name, unit, sigma, residuals}]}; before may be null
//                  against: [{name, unit, values}],  // no values: the number of the pose
//                  use,                 // of each pose: f fitted, c held out; may be empty
//                  what });             // to begin with: both, over, before, after, taken
//     chart.mark(k);                    // the pose that is shown, -1: none
import { h, number, unitText } from "./dom.js";
import { palette } from "./palette.js";
import { banded, holder, named, plot, points, rms } from "./plot.js";

const known = v => v !== null && v !== undefined;

// Columns and coordinates that vary, each once; what a model knows by another name is left out.
export function covariates(first, columns, scene, coordinates) {
  const list = [{ name: first, unit: "", values: null }], taken = new Set([first]);
  const take = (name, unit, values) => {
    if (taken.has(name) || new Set(values.filter(known)).size < 2) return;
    list.push({ name, unit: unitText(unit), values });
    taken.add(name);
  };
  for (const c of columns) take(c.name, c.unit, c.values);
  scene.coordinates.forEach((c, i) => {
    if (coordinates[i] && !taken.has(c.column) && !c.column.includes(":")) take(c.name, c.unit, coordinates[i]);
  });
  return list;
}

export function residualChart({ onpose, height = 300, ids = {} }) {
  let content = null, order = [], xs = [], marked = -1;
  const box = h("div", { class: "chart", id: ids.box, tabindex: 0, role: "img" }), summary = h("p", { class: "note", "aria-live": "polite" });
  const choice = (label, id) => {
    const select = h("select", { id, onchange: () => chart.redraw() });
    return { select, element: h("label", {}, label, " ", select) };
  };
  const measure = choice("of", ids.measure), against = choice("against", ids.against), what = choice("show", ids.what);
  const element = h("div", { hidden: true }, h("div", { class: "tools" }, measure.element, against.element, what.element), box, summary);

  function offer({ select, element }, options, wanted) {
    const before = wanted || select.value;
    element.hidden = options.length < 2;
    if (JSON.stringify([...select.options].map(o => [o.value, o.textContent])) !== JSON.stringify(options))
      select.replaceChildren(...options.map(([value, text]) => h("option", { value }, text)));
    if (options.some(([value]) => value === before)) select.value = before;
  }
  const residuals = state => state?.rows.find(r => r.name === measure.select.value)?.residuals ?? [];
  const x = () => content.against.find(c => c.name === against.select.value) ?? content.against[0];

  function series() {
    const { before, after, use = "" } = content, { values, name, unit } = x(), show = what.select.value || "after", colours = palette(), list = [];
    const count = residuals(after).length, at = k => values ? values[k] : k + 1;
    order = Array.from({ length: count }, (_, k) => k).filter(k => known(at(k)));
    order.sort((a, b) => at(a) - at(b) || a - b);
    xs = order.map(at);
    const split = use.includes("c");
    const put = (label, values, ...looks) => {
      if (values.some(v => v !== null)) list.push({ ...points(label, ...looks), ys: values });
    };
    const both = (state, colour, held, filled) => {
      const of = residuals(state), pick = c => order.map(k => (use[k] === "c") === c ? of[k] ?? null : null);
      put(split ? `${state.label}, fitted rows` : state.label, pick(false), colour, "circle", filled);
      put(`${state.label}, held out`, pick(true), held, "square", filled);
    };
    if (before && ["both", "over", "before"].includes(show)) both(before, colours.before, colours.before, false);
    if (["both", "over", "after"].includes(show)) both(after, colours.after, colours.heldout, true);
    if (before && ["over", "taken"].includes(show)) {
      const b = residuals(before), a = residuals(after);
      put("taken away: what the change of model explains", order.map(k => known(b[k]) && known(a[k]) ? b[k] - a[k] : null), colours.effect, "cross", false);
    }
    return { list, x: named(name, unit) };
  }
  const chart = holder(box, width => {
    if (!content) return null;
    const { list, x: label } = series(), row = content.after.rows.find(r => r.name === measure.select.value), unit = unitText(row.unit);
    const { before, after, use = "" } = content, of = (state, c) => number(rms(residuals(state).filter((_, k) => c === null || (use[k] === "c") === c)), 3);
    const words = [before, after].filter(Boolean).map(s => use.includes("c") ? `${s.label}: ${of(s, true)} held out, ${of(s, false)} fitted` : `${s.label}: ${of(s, null)}`);
    summary.textContent = `Root mean square of ${row.name}${unit ? ` in ${unit}` : ""}: ${words.join("; ")}.${row.sigma ? " The band is one stated sigma of what is measured." : ""}`;
    box.setAttribute("aria-label", `Residuals of ${row.name} against ${label}. ${summary.textContent} Left and right arrows choose a pose.`);
    return plot(box, xs, { width, height, x: label, y: named(row.name, unit), series: list, band: row.sigma, zoom: true,
      chosen: () => order.indexOf(marked), onpoint: k => onpose(order[k]) });
  });
  box.addEventListener("keydown", e => {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[e.key];
    if (!by || !content) return;
    e.preventDefault();
    const at = order.indexOf(marked);
    onpose(order[Math.max(0, Math.min(order.length - 1, at < 0 ? 0 : at + by))]);
  });
  return {
    element,
    get chart() { return chart.chart; },
    get data() { const { list, x: label } = series(); return { series: [{ label }, ...list], columns: [xs, ...list.map(s => s.ys)] }; },
    get content() { return content; },
    show(next) {
      content = next?.after.rows.some(r => r.residuals?.some(known)) ? next : null;
      element.hidden = !content;
      if (content) {
        const { before, after } = content;
        offer(measure, after.rows.filter(r => r.residuals?.some(known)).map(r => [r.name, r.name]));
        offer(against, content.against.map(c => [c.name, c.name]));
        offer(what, before ? [["both", "before and after"], ["over", "before, after, what was taken away"], ["before", `before: ${before.label}`],
          ["after", `after: ${after.label}`], ["taken", "what was taken away"]] : [], content.what);
        if (!before) what.select.replaceChildren();
      }
      chart.redraw();
    },
    choose(m, a) {
      if ([...measure.select.options].some(o => o.value === m)) measure.select.value = m;
      if ([...against.select.options].some(o => o.value === a)) against.select.value = a;
      chart.redraw();
    },
    mark(k) {
      if (k === marked) return;
      marked = k;
      chart.chart?.mark();
    },
  };
}

// What the poses ask for at a finding's place, before and after, and the fitted effect with its band.
// points: [{x, before, after, fitted, std, fitted_std, count}], bins along x.
export function curveChart(curve, list) {
  const of = key => list.map(p => p[key]), most = list.reduce((n, p) => Math.max(n, p.count), 0), least = list.reduce((n, p) => Math.min(n, p.count), most);
  const box = h("div", { class: "chart curve", role: "img", "aria-label":
    `${curve.y} against ${curve.x}: ${list.length} bins before and after, and the fitted effect with twice its standard uncertainty` });
  holder(box, width => {
    const colours = palette();
    return plot(box, of("x"), { width: Math.min(width, 760), height: 300, x: named(curve.x, unitText(curve.x_unit)), y: named(curve.y, unitText(curve.unit)), series: [
      { ...banded("fitted effect", colours.effect, list.map(p => 2 * (p.fitted_std ?? 0))), ys: of("fitted") },
      { ...points("before", colours.before, "circle", false, of("std")), ys: of("before") },
      { ...points("after", colours.after, "square", true, of("std")), ys: of("after") }] });
  });
  return h("figure", {}, box, h("figcaption", {}, `What the fitted poses ask for, in bins of ${least === most ? least : `${least} to ${most}`} poses, each with its standard uncertainty; `
    + "the line is the effect that was fitted, its band twice the standard uncertainty. A constant and a slope are mostly missing: the geometry takes them up."));
}
