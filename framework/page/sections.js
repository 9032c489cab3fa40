// The parts of the report, each made from the command's own JSON; what a report has not is left out.
import { covariates, curveChart, residualChart } from "./charts.js";
import { download, h, number, section, signed, spoken, table, unitText, withStd } from "./dom.js";
import { consecutive, valuesAt } from "./linkage.js";

const T = title => ({ title, text: true }), N = title => ({ title }), U = title => ({ title, text: true, short: true });
const chance = p => p === null || p === undefined ? "–" : p < 0.001 ? "< 0.001" : number(p, 2);

const manyAmounts = 8;  // a curve's heights

export function verdict(data) {
  const header = document.getElementById("verdict"), headline = header.querySelector(".headline");
  if (headline.textContent.length > 110) headline.classList.add("long");
  header.append(...data.sentences.map(s => h("p", {}, s)));
}

export function residuals(store) {
  const { data } = store, judged = data.states.filter(s => s.rows.some(r => r.residuals?.some(v => v !== null)));
  if (!judged.length) return null;
  const chart = residualChart({ onpose: store.setPose, ids: { box: "residuals", measure: "measure", against: "against", what: "what" } });
  // Before and after: the last two states with residuals. Of `axes` the states are different
  // recordings, of which the one in the picture is shown.
  const several = data.command === "axes";
  const show = () => {
    const after = several && judged.includes(store.current) ? store.current : judged.at(-1), before = several ? null : judged.at(-2) ?? null;
    chart.show({ before, after, use: after.columns ? "" : data.use, what: chart.content ? undefined : before && before.label !== "nominal" ? "both" : "after",
      against: covariates("row", after.columns ?? data.columns, store.sceneOf(after), after.coordinates) });
    chart.mark(store.pose);
  };
  show();
  if (several) store.on("state", show);
  store.on("pose", () => chart.mark(store.pose));
  if (several && judged.length > 1) {
    const select = h("select", { id: "recording", onchange: () => store.setState(+select.value) },
      [...judged.slice(-1), ...judged.slice(0, -1)].map(s => h("option", { value: data.states.indexOf(s), selected: s === store.current }, s.label)));
    store.on("state", () => { select.value = store.state; });
    chart.element.querySelector(".tools").prepend(h("label", {}, "recording ", select));
  }
  window.talusCharts = { residuals: chart };
  const report = data.report ?? {};
  const list = [];
  const measures = (title, of) => {
    if (!of?.length) return;
    list.push(table([T("measure"), U("unit"), N("poses"), N("bias"), N("precision"), N("RMSE"), N("range"), N("% of range")],
      of.map(m => [m.name, unitText(m.unit), m.count, number(m.bias, 3), number(m.precision, 3), number(m.rmse, 3), number(m.fsr, 4), number(m.percent_fsr, 3)]),
      { caption: title }));
  };
  const fits = report.after && report.findings?.length ? [["before", report.baseline_clean ?? report.baseline], ["after", report.after]]
    : report.baseline ? [["", report.baseline]] : [];
  for (const [label, fit] of fits) {
    measures(`Rows held out${label ? ", " + label : ""}`, fit.measures);
    measures(`Rows fitted${label ? ", " + label : ""}`, fit.measures_fit);
  }
  return section("residuals-part", "Residuals: measured − modelled", chart.element,
    h("p", { class: "note noprint" }, "Choose a point to see its pose; drag to enlarge, double-click to go back."),
    list.length ? h("details", { class: "paper" }, h("summary", {}, "Errors of each measure"), list) : null);
}

export function findings(store) {
  const { report } = store.data;
  if (!report?.findings) return null;
  const card = (f, kind, at) => {
    const parts = store.data.sentences.includes(f.statement) ? [] : [h("p", {}, f.statement)];
    const points = store.data.curves?.[at]?.length ? store.data.curves[at] : f.curve?.points;
    if (points?.length) parts.push(curveChart(f.curve, points));
    if (f.formula?.statement) parts.push(h("p", {}, f.formula.statement, f.formula.expression ? h("code", {}, " " + f.formula.expression) : null));
    const values = table([T("parameter"), N("value"), N("std"), U("unit")], f.parameters.map(p => [spoken(p.name), withStd(p.value, p.std), number(p.std, 2), unitText(p.unit)]));
    parts.push(f.parameters.length > manyAmounts ? h("details", {}, h("summary", {}, `The ${f.parameters.length} parameters of the curve`), values) : values);
    const e = f.evidence;
    parts.push(h("p", { class: "note" }, `Evidence: chi-square ${number(e.delta_chi2, 4)} is lost without it, ${number(e.sigmas_per_pose, 3)} sigmas per pose; `
      + `p ${chance(e.p_value)} of the best of all candidates by chance; held out ${number(e.heldout_rms_before, 3)} → ${number(e.heldout_rms_after, 3)} sigmas.`));
    if (f.rivals.length) parts.push(table([T("explanation"), T("place"), N("probability")],
      [[spoken(f.effect), f.location, number(f.probability, 3)], ...f.rivals.map(r => [spoken(r.effect), r.location, number(r.probability, 3)])],
      { caption: "Rivals: what else it could be" }));
    const show = store.keyOf(f.location.replace(/^.* of /, ""));
    return h("article", {}, h("h3", {}, `${spoken(f.effect)} at ${f.location}${kind}`, " ",
      show ? h("button", { type: "button", class: "noprint", onclick: () => store.light(show) }, "show") : null), parts);
  };
  const held = report.heldout, list = [];
  if (held?.poses && report.findings.length) {
    const rows = [["rows drawn at random", held.poses, number(held.before, 3), number(held.after, 3),
      held.after_95_percent ? `${number(held.after_95_percent[0], 3)} to ${number(held.after_95_percent[1], 3)}` : "–", chance(held.p_value)],
      ...held.blocks.map(b => [b.name, b.poses, number(b.before, 3), number(b.after, 3), "", ""])];
    list.push(table([T("held out"), N("poses"), N("before"), N("after"), T("95 % of after"), N("p")], rows,
      { caption: "Rows that took no part in the fit: root mean square in sigmas" }));
  }
  if (!report.findings.length && !report.hints.length && !list.length) return null;
  return section("findings", "What was found", list, report.findings.map((f, i) => card(f, "", i)),
    report.hints.length ? h("h3", {}, "Hints: significant, but too small to be claimed") : null, report.hints.map((f, i) => card(f, " (hint)", report.findings.length + i)));
}

export function suspects(store) {
  const { report } = store.data;
  if (!report?.sensitivity?.length) return null;
  const found = new Set(report.findings.map(f => f.effect + " " + f.location)), hinted = new Set(report.hints.map(f => f.effect + " " + f.location));
  const rows = [...report.sensitivity].sort((a, b) => (a.smallest_visible === null) - (b.smallest_visible === null)
    || a.smallest_visible / a.typical - b.smallest_visible / b.typical);
  const verdictOf = s => found.has(s.effect + " " + s.location) ? "found" : hinted.has(s.effect + " " + s.location) ? "hint"
    : s.smallest_visible === null ? "cannot be seen" : s.smallest_visible > s.typical ? "not excluded" : "rejected";
  // On paper: all but the rejected ones, and of these the nearest to not being so.
  const rejected = rows.filter(s => verdictOf(s) === "rejected"), off = new Set(rejected.slice(0, -10));
  const cells = rows.map(s => [spoken(s.effect), s.location, verdictOf(s), s.smallest_visible === null ? "–" : number(s.smallest_visible, 3), number(s.typical, 3),
    unitText(s.unit), s.visible_share === null ? "–" : number(100 * s.visible_share, 3), s.nearest_rival ? spoken(s.nearest_rival) : "–", s.nearest_rival ? number(100 * s.imitated, 3) : "–"]);
  const body = h("div", { class: "tall", tabindex: 0 }, table([T("suspect"), T("place"), T("verdict"), N("smallest seen"), N("usual"), U("unit"), N("% left by geometry"),
    T("nearest rival"), N("% imitated")], cells, { paper: k => !off.has(rows[k]) }),
    off.size ? h("p", { class: "note onpaper" }, `On paper the ${off.size} suspects farthest from going unseen are left out, all of them rejected; they are in the file.`) : null);
  const parts = [h("p", { class: "note" }, "Every effect at every place: the smallest magnitude that 80 of 100 such recordings would have shown, what is usual, and what it would be taken for. Rejected: at its usual size it would have been seen, and was not. Not excluded: it would not have been seen."), body];
  if (report.untestable?.length) parts.push(h("details", {}, h("summary", {}, `${report.untestable.length} suspects that these recordings cannot test`),
    table([T("suspect"), T("place"), T("not recorded")], report.untestable.map(u => [spoken(u.effect), u.location, u.lacks]))));
  if (report.twins?.length) parts.push(h("details", {}, h("summary", {}, "Groups that no pose of these kinds tells apart"), report.twins.map(t => h("p", {}, spoken(t.join(", "))))));
  if (report.blind_spots?.length) parts.push(h("details", {}, h("summary", {}, "What no analysis of these recordings can see"),
    report.blind_spots.map(b => h("p", {}, h("strong", {}, b.name + ": "), b.statement))));
  return section("suspects", "Suspects, rejected ones too", parts);
}

export function parameters(store) {
  const { report } = store.data;
  const before = report?.baseline, after = report?.after && report.findings?.length ? report.after : null, fit = after ?? before;
  if (!fit?.parameters?.length) return null;
  const list = [...fit.parameters, ...fit.shared].filter(p => !p.held_out), old = new Map((before?.parameters ?? []).map(p => [p.name, p]));
  const columns = [T("parameter"), U(""), N("nominal"), ...(after ? [N("before")] : []), N(after ? "after" : "calibrated"), N("difference"), N("std"), N("tolerance"), N("seen")];
  const heights = new Map();  // of a curve: many of one element, with names that end in numbers
  const element = p => /^(.*)\.c\d+$/.exec(p.name)?.[1];
  for (const p of list) if (element(p)) heights.set(element(p), (heights.get(element(p)) ?? 0) + 1);
  const off = p => heights.get(element(p)) > manyAmounts;
  const rows = list.map(p => {
    const seen = p.at_bound ? "at its bound" : p.identifiable ? "yes" : "not alone";
    return [p.name, unitText(p.unit), number(p.nominal, 6), ...(after ? [old.has(p.name) ? withStd(old.get(p.name).value, p.std) : "–"] : []), withStd(p.value, p.std),
      signed(p.difference, 3), number(p.std, 2), p.tolerance === null ? "–" : number(p.tolerance, 3),
      seen === "yes" ? seen : h("span", { class: "bad" }, seen)];
  });
  return section("parameters", "Parameters", h("div", { class: "tall", tabindex: 0 }, table(columns, rows, { onrow: k => store.light(store.keyOf(list[k].name)), keys: list.map(p => p.name), paper: k => !off(list[k]) }),
    list.some(off) ? h("p", { class: "note onpaper" }, "On paper the heights of a curve are left out; they are in the file.") : null),
    h("p", { class: "note" }, `Standard uncertainties include the tolerance as prior knowledge. ${fit.directions_seen} of ${fit.directions} directions are seen.`));
}

export function unseen(store, panel) {
  const { data } = store;
  if (!data.directions.length) return null;
  let playing = 0, at = -1;
  const buttons = [];
  function stop() {
    cancelAnimationFrame(playing);
    if (at >= 0) { buttons[at].textContent = "Play"; buttons[at].setAttribute("aria-pressed", "false"); }
    at = -1;
    playing = 0;
    store.vary(null);
    panel.viewer.ghosts([]);
    panel.viewer.visible({ frames: true });
    panel.update();
  }
  // So far that the frame that moves most moves by a twelfth of the linkage, or turns by 20 degrees.
  function scaleOf(d) {
    const state = data.states[d.state], scene = store.sceneOf(state), base = valuesAt(scene, store.coordinates(state, store.pose), state.base);
    const moved = Float64Array.from(state.base);
    let largest = 0;
    for (const [, v] of d.changes) largest = Math.max(largest, Math.abs(v));
    const small = 1e-4 / largest;
    for (const [slot, v] of d.changes) moved[slot] += small * v;
    const out = valuesAt(scene, store.coordinates(state, store.pose), moved);
    let most = 0, size = 1, turns = 0;
    for (const f of scene.frames) {
      most = Math.max(most, Math.hypot(...[3, 7, 11].map(i => out[f.at + i] - base[f.at + i])) || 0);
      turns = Math.max(turns, Math.hypot(...[0, 1, 2, 4, 5, 6, 8, 9, 10].map(i => out[f.at + i] - base[f.at + i])) / Math.SQRT2 || 0);
      size = Math.max(size, Math.hypot(...[3, 7, 11].map(i => base[f.at + i] - base[scene.frames[1]?.at + i || 0])) || 0);
    }
    return Math.min(most > 1e-9 ? small * 0.085 * size / most : Infinity, turns > 1e-9 ? small * 0.35 / turns : Infinity, 60 / largest);
  }
  function start(i) {
    if (at >= 0) { const same = at === i; stop(); if (same) return; }
    const d = data.directions[i];
    if (store.state !== d.state) store.setState(d.state);
    at = i;
    panel.viewer.visible({ frames: "all" });
    buttons[i].textContent = "Stop";
    buttons[i].setAttribute("aria-pressed", "true");
    const scale = scaleOf(d), ghost = { values: store.outputs(store.current), scene: store.scene, colour: "#888888" };
    let began = 0;
    const step = time => {
      began ||= time;
      const share = Math.sin((time - began) / 700);
      store.vary(d.changes.map(([slot, v]) => [slot, share * scale * v]));
      panel.viewer.ghosts([ghost]);
      playing = requestAnimationFrame(step);
    };
    playing = requestAnimationFrame(step);
  }
  const list = data.directions.map((d, i) => {
    const button = h("button", { type: "button", class: "noprint", "aria-pressed": "false", onclick: () => start(i) }, "Play");
    buttons.push(button);
    return h("p", {}, d.changes.length ? button : null, " ", d.sentence);
  });
  return section("unseen", "What these recordings do not see",
    h("p", { class: "note noprint" }, "Played: the linkage as it changes along such a direction, exaggerated. If the measured feature moved against what it is measured in, the recordings would see it: what moves, perhaps only a frame, is what they do not tell."), list);
}

export function nextPoses(store, panel) {
  const { data } = store, list = data.report?.next_poses;
  if (!list?.length) return null;
  const scene = data.linkages[data.states[0].linkage], gain = data.report.next_poses_gain;
  const cards = list.map((pose, k) => {
    const canvas = h("canvas", { width: 460, height: 300, role: "img", "aria-label": `pose ${k + 1} of those to record next` });
    const draw = () => panel.viewer.snapshot(canvas, valuesAt(scene, scene.coordinates.map((c, i) => data.next[k]?.[i] ?? c.rest), data.states[0].base));
    requestAnimationFrame(draw);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
    matchMedia("print").addEventListener("change", draw);
    const readings = Object.entries(pose.readings).map(([name, r]) => `${name} ${number(r.value, 4)}${unitText(r.unit) ? " " + r.unit : ""}`).join(", ");
    return h("button", { type: "button", class: "card", onclick: () => store.setAll(scene, data.next[k] ?? []) }, canvas,
      h("div", {}, h("strong", {}, `${k + 1}. `), readings), pose.how ? h("div", {}, pose.how) : null, h("div", { class: "note" }, pose.for));
  });
  return section("next", "Poses to record next", gain?.statement ? h("p", {}, gain.statement) : null, h("div", { class: "cards" }, cards));
}

export function axes(store) {
  const holder = h("div", {}), names = i => store.scene.axes[i].joint;
  let written = "";
  const write = () => {
    const scene = store.scene, pairs = consecutive(scene, store.outputs(store.current));
    const rows = pairs.map(p => [`${names(p.first)} – ${names(p.second)}`, number(p.angle < 1e-9 ? 0 : p.angle / scene.angle.factor, 5), scene.angle.unit,
      number(p.distance < 1e-9 ? 0 : p.distance / scene.length.factor, 5), scene.length.unit]);
    const text = JSON.stringify(rows);
    if (text === written) return;
    written = text;
    holder.replaceChildren(rows.length ? table([T("axes"), N("angle"), U(""), N("shortest distance"), U("")], rows,
      { onrow: k => store.light("joint:" + names(pairs[k].second)) }) : h("p", {}, "There are no two axes that follow each other."));
  };
  write();
  store.on("posture", write);
  return section("axes", "Joint axes", h("p", { class: "note" }, "Angle and shortest distance between axes that follow each other, in the posture and model shown."), holder);
}

// What `talus axes` found.
export function located(store) {
  const { report } = store.data, whole = report?.whole;
  if (!whole) return null;
  const parts = whole.by_recording.map(r => [h("h3", {}, r.recordings),
    table([T("axis"), T("variable"), N("value"), N("std"), U("unit")], r.axes.flatMap(a => a.determined
      ? a.variables.map((v, i) => [i ? "" : a.name, v.name, withStd(v.value, v.std), number(v.std, 2), v.unit]) : [[a.name, a.why, "–", "–", ""]])),
    r.apart.length ? table([T("axes"), N("angle"), N("std"), N("distance"), N("std")], r.apart.map(p => [p.axes.join(" – "), withStd(p.angle, p.angle_std), number(p.angle_std, 2),
      withStd(p.distance, p.distance_std), number(p.distance_std, 2)])) : null]);
  const changes = whole.changes.map(c => [h("h3", {}, `Change from ${whole.by_recording[0].recordings} to ${c.recordings}`),
    table([T("axis"), T("variable"), N("change"), N("std"), U("unit")], c.axes.filter(a => a.determined).flatMap(a => a.variables.map((v, i) => [i ? "" : a.name, v.name, withStd(v.value, v.std), number(v.std, 2), v.unit])))]);
  return section("located", "Axes located", parts, changes);
}

export function equations(store) {
  const { scene } = store, name = i => scene.frames[i].label;
  const lines = scene.equations.map(e => {
    if (e.reading) return h("p", { class: "equation" }, h("i", {}, e.reading), " = ", h("span", { class: "amount" }, e.text));
    const motions = e.motions.flatMap(m => m.kind === "matrix" ? [" [", h("span", { class: "amount" }, m.text), "]"]
      : [" ", m.kind === "R" ? "Rot" : "Trans", h("sub", {}, m.axis), "(", h("span", { class: "amount" }, m.text), ")"]);
    const key = store.keyOf(scene.frames[e.frame].name);
    return h("p", { class: "equation" }, h("i", {}, "T"), h("sub", {}, `${name(e.parent)}→${name(e.frame)}`), " =", motions.length ? motions : " I", " ",
      key ? h("button", { type: "button", class: "noprint", onclick: () => store.light(key) }, "show") : null);
  });
  return h("details", { id: "equations", class: "paper" }, h("summary", {}, "Equations of the chain"), h("p", { class: "note" }, "Each joint as the product of its elementary motions, with the effects of the model; angles in rad and lengths in mm where a formula holds plain numbers."), lines);
}

export function source(store) {
  const { sources, changes = [] } = store.data;
  if (!sources.length) return null;
  const told = changes.length ? h("p", { id: "changes" }, "With ", changes.flatMap((c, i) => [i ? ", " : "", h("code", {}, `${c.name} = ${c.text}`)]),
    " by --set: the text below is that of the file.") : null;
  const parts = sources.map(s => {
    const box = h("div", { class: "source", tabindex: 0, role: "group", "aria-label": s.file }), lines = s.text.replace(/\n$/, "").split("\n"), of = new Map();
    for (const e of s.elements) {
      const key = store.keyOf(e.name) ?? store.keyOf(e.at?.split(",")[0].trim()) ?? store.keyOf(e.of);
      if (key && !of.has(e.line)) of.set(e.line, key);
    }
    lines.forEach((text, i) => {
      const key = of.get(i + 1), set = changes.filter(c => c.file === s.file && c.line === i + 1);
      box.append(h("div", { class: set.length ? "set" : null, tabindex: key ? 0 : null, "data-key": key, onclick: key ? () => store.light(key) : () => {},
        onkeydown: e => { if (key && e.key === "Enter") store.light(key); } }, h("span", { class: "n" }, String(i + 1)), text,
        set.length ? h("span", { class: "note" }, `   set: ${set.map(c => `${c.name} = ${c.text}`).join(", ")}`) : null));
    });
    store.on("lit", () => {
      let first = true;
      for (const line of box.children) {
        const lit = store.lit !== null && line.dataset.key === store.lit;
        line.classList.toggle("lit", lit);
        if (lit && first) { box.scrollTop = line.offsetTop - box.offsetTop - box.clientHeight / 3; first = false; }
      }
    });
    return [h("h3", {}, s.file), box];
  });
  return section("source", "The model", h("p", { class: "note noprint" }, "Choose a line to see its joint or frame, or a joint in the picture to see its line."), told, parts, equations(store));
}

function csv(store, columns = store.data.columns, use = store.data.use) {
  const cell = v => v === null || v === undefined ? "" : String(v);
  const rows = columns[0]?.values.length ?? 0, list = columns.map(c => ({ head: c.name + (unitText(c.unit) ? `[${c.unit}]` : ""), of: k => cell(c.values[k]) }));
  if (use && !columns.some(c => c.name === "use")) list.push({ head: "use", of: k => ({ f: "fit", c: "check" })[use[k]] ?? "" });
  return { recordings: [list.map(c => c.head).join(","), ...Array.from({ length: rows }, (_, k) => list.map(c => c.of(k)).join(","))].join("\n") + "\n",
    residuals: () => {
      const all = store.data.states.flatMap(s => s.rows.filter(r => r.residuals).map(r => ({ head: `${s.label}: ${r.name}${unitText(r.unit) ? `[${r.unit}]` : ""}`, r })));
      const n = all[0]?.r.residuals.length ?? 0;
      return [["row", ...all.map(c => `"${c.head}"`)].join(","), ...Array.from({ length: n }, (_, k) => [k + 1, ...all.map(c => cell(c.r.residuals[k]))].join(","))].join("\n") + "\n";
    } };
}

export function footer(store) {
  const { data } = store, stem = (data.files.at(-1)?.file ?? data.title).split("/").at(-1).replace(/\.[^.]*$/, "");
  const tables = csv(store), buttons = [];
  const button = (text, f) => buttons.push(h("button", { type: "button", onclick: f }, text));
  if (data.columns.length) button("Recordings (CSV)", () => download(stem + ".csv", "text/csv", tables.recordings));
  if (data.states.some(s => s.rows.some(r => r.residuals))) button("Residuals (CSV)", () => download(stem + "-residuals.csv", "text/csv", tables.residuals()));
  if (data.report) button("Report (JSON)", () => download(stem + "-report.json", "application/json", JSON.stringify(data.report, null, 1)));
  for (const s of data.states) if (s.columns) button(`${s.label} (CSV)`, () => download(`${s.label.split("/").at(-1).replace(/\.[^.]*$/, "")}.csv`, "text/csv", csv(store, s.columns, "").recordings));
  button("All of this page's data (JSON)", () => download(stem + "-page.json", "application/json", JSON.stringify(data)));
  for (const s of data.sources) button(s.file.split("/").at(-1), () => download(s.file.split("/").at(-1), "text/plain", s.text));
  document.getElementById("footer").append(h("p", { class: "noprint" }, "Download: ", buttons.flatMap(b => [b, " "])),
    h("p", {}, `Made by talus ${data.talus}. To make it again: `, h("code", {}, data.command_line)),
    ...data.files.map(f => h("p", {}, `${f.file}: SHA-256 ${f.sha256}`)));
}
