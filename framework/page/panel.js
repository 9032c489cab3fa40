// The linkage with its sliders, ghosts, arrows and playback.
import { h, number, unitText } from "./dom.js";
import { add, origin, times, turned, column, cross, norm, sub, unit } from "./linkage.js";
import { palette } from "./palette.js";
import { createViewer } from "./viewer.js";

const views = { front: [-Math.PI / 2, 0], side: [0, 0], top: [-Math.PI / 2, Math.PI / 2], oblique: [-Math.PI / 3, 25 * Math.PI / 180] };

export function makePanel(element, store) {
  const { data } = store, states = data.states;
  const stage = h("div", { class: "stage" }), view = h("div");
  stage.append(view);
  element.append(stage);
  const flat = location.hash === "#flat";
  const viewer = createViewer(view, store.scene, { flat, values: store.outputs(store.current) });
  viewer.onpick = key => store.light(key);
  function roomFor() {  // for the recorded poses, or a few of very many
    const list = [viewer.values], count = store.poseCount(), state = store.withPoses();
    const keep = new Map(store.values);
    for (let i = 0; i < Math.min(count, 60); ++i) {
      store.take(Math.floor(i * count / Math.min(count, 60)));
      list.push(store.outputs(state));
    }
    store.values = keep;
    viewer.frame(count ? list.slice(1) : list);
  }
  const show = { ghosts: new Set(), measured: true, arrows: data.columns.length > 0, factor: 1, all: false };
  // A factor that makes the usual arrow about a tenth of the linkage.
  show.factor = usualFactor();

  function usualFactor() {
    let sum = 0, count = 0;
    for (const list of Object.values(store.current.offsets ?? {}))
      for (let k = 0; k < (list[0]?.length ?? 0); ++k)
        if (list[0][k] !== null) { sum += list[0][k] ** 2 + list[1][k] ** 2 + list[2][k] ** 2; ++count; }
    const wanted = 0.12 * sizeOf() / (Math.sqrt(sum / count) || 1);
    return [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].findLast(f => f <= wanted) ?? 1;
  }
  function sizeOf() {
    const points = store.scene.frames.slice(1).map(f => origin(viewer.values, f.at));
    return Math.max(1, ...points.map(p => norm(sub(p, points[0])) || 0));
  }

  // Where a feature is measured at a recorded pose, and the arrow from where it is modelled.
  function arrowsAt(state, values, pose, colours, marks, whole) {
    const scene = store.sceneOf(state), size = sizeOf();
    for (const f of scene.features) {
      const list = state.offsets?.[f.name];
      if (!list || list[0][pose] === null) continue;
      const at = scene.frames[f.in].at, modelled = origin(values, f.at);
      const off = turned(values, at, [0, 1, 2].map(i => list[i][pose]));
      if (f.kind === "direction") {
        const ray = add(modelled, times(0.13 * size, column(values, f.at, 2)));
        if (show.arrows) marks.push({ from: ray, to: add(ray, times(0.13 * size * show.factor, off)), colour: colours.arrow });
        continue;
      }
      const measured = add(modelled, off);
      if (show.measured && whole) {
        marks.push({ at: measured, colour: colours.arrow, radius: 5 });
        if (list.length === 6 && list[3][pose] !== null) {  // measured frame: modelled, turned by a rotation vector
          const w = turned(values, at, [3, 4, 5].map(i => list[i][pose]));
          for (let j = 0; j < 3; ++j) {
            const axis = column(values, f.at, j), tilted = rotated(axis, w);
            marks.push({ from: measured, to: add(measured, times(0.07 * size, tilted)), colour: colours.arrow, width: 1, tip: false });
          }
        }
      }
      if (show.arrows) marks.push({ from: modelled, to: add(modelled, times(show.factor, off)), colour: colours.arrow });
    }
  }
  const rotated = (v, w) => {
    const angle = norm(w), u = unit(w), c = Math.cos(angle), s = Math.sin(angle);
    return add(add(times(c, v), times(s, cross(u, v))), times((1 - c) * (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]), u));
  };

  let everywhere = null;  // arrows at all poses: worked out once per state and factor
  function update() {
    const colours = palette(), state = store.current;
    viewer.show(store.outputs(state));
    viewer.ghosts([...show.ghosts].filter(i => i !== store.state).map(i => ({
      values: store.outputs(states[i]), scene: store.sceneOf(states[i]), colour: colours.ghosts[i % colours.ghosts.length] })));
    const marks = [];
    if (show.all && show.arrows) {
      const key = `${store.state} ${show.factor} ${colours.arrow}`;
      if (everywhere?.key !== key) {
        everywhere = { key, marks: [] };
        const keep = store.pose, values = new Map(store.values);
        for (let k = 0; k < store.poseCount(); ++k) {
          store.pose = k;
          arrowsAt(state, store.outputs(state), k, colours, everywhere.marks, false);
        }
        store.pose = keep;
        store.values = values;
      }
      marks.push(...everywhere.marks);
    }
    if (store.pose >= 0) arrowsAt(state, viewer.values, store.pose, colours, marks, true);
    viewer.marks(marks);
    sliders.refresh();
  }

  // Tools above and below.
  const check = (label, on, f) => h("label", {}, h("input", { type: "checkbox", checked: on, onchange: e => f(e.target.checked) }), label);
  const tools = h("div", { class: "tools" });
  if (states.length > 1)
    tools.append(h("label", {}, "model ", h("select", { id: "state", onchange: e => store.setState(+e.target.value) },
      states.map((s, i) => h("option", { value: i, selected: i === store.state }, s.label)))));
  const ghostBoxes = states.map((s, i) => {
    if (states.length < 2) return null;
    const box = check(`ghost: ${s.label}`, false, on => { on ? show.ghosts.add(i) : show.ghosts.delete(i); update(); });
    box.style.color = palette().ghosts[i % palette().ghosts.length];
    return box;
  });
  const parts = h("div", { class: "tools" },
    check("bodies", true, on => viewer.visible({ bodies: on })),
    check("joints", true, on => viewer.visible({ joints: on })),
    check("all frames", false, on => viewer.visible({ frames: on ? "all" : true })),
    check("angle and distance of axes", false, on => viewer.visible({ apart: on })),
    check("names", true, on => viewer.visible({ names: on })));
  const looks = h("div", { class: "tools" }, h("span", { class: "together" }, "view ",
    Object.entries(views).map(([name, [a, e]]) => h("button", { type: "button", onclick: () => viewer.from(a, e) }, name)),
    h("button", { type: "button", title: "0", onclick: () => viewer.fit() }, "fit"),
      store.poseCount() > 1 ? h("button", { type: "button", onclick: roomFor }, "fit all poses") : ""),
    h("label", {}, "up ", h("select", { onchange: e => viewer.up(e.target.value) },
      ["z", "y", "x", "-z", "-y", "-x"].map(a => h("option", {}, a)))));
  tools.append(...ghostBoxes.filter(Boolean));
  const hideOwn = () => ghostBoxes.forEach((box, i) => { if (box) box.hidden = i === store.state; });
  hideOwn();
  const hasOffsets = states.some(s => s.offsets && Object.keys(s.offsets).length);
  if (hasOffsets) {
    tools.append(check("measured", true, on => { show.measured = on; update(); }),
      check("residual arrows", true, on => { show.arrows = on; update(); }),
      h("label", {}, "× ", h("select", { id: "factor", "aria-label": "length of the residual arrows",
        onchange: e => { show.factor = +e.target.value; update(); } },
        [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].map(f => h("option", { value: f, selected: f === show.factor }, f)))),
      check("at all poses", false, on => { show.all = on; update(); }));
  }
  parts.append(...looks.childNodes);
  element.append(tools, parts);

  // Recorded poses.
  let playing = 0, began = 0, from = 0;
  const which = h("output", { for: "pose" }), slider = h("input", { type: "range", id: "pose", min: 0,
    max: Math.max(0, store.poseCount() - 1), step: 1, value: 0, "aria-label": "recorded pose",
    oninput: e => { stop(); store.setPose(+e.target.value); } });
  const play = h("button", { type: "button", onclick: () => playing ? stop() : start() }, "Play");
  const speed = h("select", { "aria-label": "poses a second", onchange: () => { if (playing) { stop(); start(); } } },
    [0.5, 1, 2, 5, 10, 30].map(v => h("option", { value: v, selected: v === (store.poseCount() > 300 ? 30 : 2) }, `${v}/s`)));
  function stop() { cancelAnimationFrame(playing); playing = 0; play.textContent = "Play"; }
  function start() {
    roomFor();
    from = store.pose >= 0 && store.pose < store.poseCount() - 1 ? store.pose : 0;
    began = 0;
    play.textContent = "Pause";
    const step = time => {
      began ||= time;
      const at = from + (time - began) / 1000 * +speed.value;
      if (at >= store.poseCount() - 1) { store.setPose(store.poseCount() - 1); return stop(); }
      store.between(Math.floor(at), at % 1);
      slider.value = Math.floor(at);
      playing = requestAnimationFrame(step);
    };
    playing = requestAnimationFrame(step);
  }
  if (store.poseCount() > 1) element.append(h("div", { class: "pose" }, play, slider, which, speed));

  const sliders = makeSliders(store, stop);
  element.append(sliders.element);

  store.on("posture", update);
  store.on("state", () => {
    const select = element.querySelector("#state");
    if (select) select.value = store.state;
    hideOwn();
    slider.max = Math.max(0, store.poseCount() - 1);
    rebuild();
  });
  store.on("pose", () => {
    const word = { f: "fitted", c: "held out", "-": "left out" }[store.current.columns ? "f" : data.use[store.pose]];
    which.textContent = store.pose < 0 ? "" : `row ${store.pose + 1}${word ? ", " + word : ""}`;
    if (store.pose >= 0) slider.value = store.pose;
  });
  store.on("lit", () => viewer.highlight(store.lit));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", update);
  let shown = store.scene;
  function rebuild() {  // another linkage: its own shapes
    if (store.scene === shown) return;
    shown = store.scene;
    viewer.scene(shown, store.outputs(store.current));
    sliders.rebuild();
  }
  return { viewer, update, stop };
}

function makeSliders(store, stop) {
  const element = h("div", { class: "sliders" });
  let rows = [];
  function rebuild() {
    element.replaceChildren();
    rows = store.scene.coordinates.filter(c => !c.circumstance).map(c => {
      const step = 10 ** Math.floor(Math.log10((c.high - c.low || 1) / 500));
      const set = v => { if (Number.isFinite(v)) { stop(); store.set(c.name, v); } };
      const range = h("input", { type: "range", min: c.low, max: c.high, step: "any", "aria-label": `${c.name} (${c.unit})`,
        oninput: e => set(+e.target.value),
        onkeydown: e => {
          const by = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageUp: 10, PageDown: -10 }[e.key];
          if (!by) return;
          e.preventDefault();
          set(Math.max(c.low, Math.min(c.high, +range.value + by * step)));
        } });
      const box = h("input", { type: "number", step, "aria-label": `${c.name} (${c.unit}), as a number`,
        onchange: e => set(+e.target.value) });
      element.append(h("div", { class: "row" }, h("label", { title: c.limited ? "limits of the sensor" : "limits for looking only" }, c.name),
        h("span", { class: "limit" }, number(c.low, 4)), range, h("span", { class: "limit" }, number(c.high, 4)), box,
        h("span", {}, unitText(c.unit)), h("button", { type: "button", title: `${c.name} at rest`, "aria-label": `${c.name} at rest`,
          onclick: () => set(c.rest) }, "↺")));
      return { c, range, box };
    });
    element.append(h("div", { class: "tools" }, h("button", { type: "button", id: "reset", onclick: () => { stop(); store.rest(); } }, "All at rest")));
    refresh();
  }
  function refresh() {
    for (const { c, range, box } of rows) {
      const v = store.values.get(c.name) ?? c.rest;
      if (document.activeElement !== range || +range.value !== v) range.value = v;
      if (document.activeElement !== box) box.value = +v.toFixed(4);
    }
  }
  rebuild();
  return { element, refresh, rebuild };
}
