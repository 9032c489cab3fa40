// The linkage and its sliders. The core works out where everything is; the viewer shows it.
import { h, number, unitText } from "../../page/dom.js";
import { axisLine, consecutive, origin } from "../../page/linkage.js";
import { createViewer } from "../../page/viewer.js";

// locate(coordinates) -> the list of numbers that the viewer shows, a promise.
export function makeStage(element, { locate, onpick, onpose }) {
  const view = h("div"), box = h("div", { class: "stage" }, view), sliders = h("div", { class: "sliders" });
  const boxes = {}, visible = { apart: false };
  const check = (label, part, on, shown = true) => {
    boxes[part] = h("input", { type: "checkbox", checked: on, onchange: e => visibly({ [part]: e.target.checked ? shown : part === "frames" }) });
    return h("label", {}, boxes[part], label);
  };
  const tools = h("div", { class: "tools" },
    check("all frames", "frames", false, "all"),
    check("names", "names", true),
    check("angle and distance of axes", "apart", false),
    h("button", { type: "button", onclick: () => viewer?.fit() }, "Fit"),
    h("button", { type: "button", onclick: () => move(scene.coordinates.map(c => c.rest)) }, "All at rest"));
  element.append(box, tools, sliders);
  let scene = null, viewer = null, at = [], rows = [], swinging = 0, asked = 0, busy = false, again = false;

  function visibly(parts) {
    Object.assign(visible, parts);
    if ("apart" in parts) boxes.apart.checked = parts.apart;
    viewer?.visible(parts);
  }
  // One question at a time; what has changed meanwhile is asked next.
  async function relocate() {
    if (busy) { again = true; return; }
    busy = true;
    const of = scene, values = await locate(at);
    busy = false;
    if (values && of === scene) { viewer.show(values); onpose?.(values, at); }
    if (again) { again = false; relocate(); }
  }
  function move(coordinates, from = null) {
    if (from === null) still();
    scene?.coordinates.forEach((c, i) => { if (Number.isFinite(coordinates[i])) at[i] = coordinates[i]; });
    rows.forEach(({ i, range, input }) => {
      if (document.activeElement !== input) input.value = String(+at[i].toFixed(4));
      range.value = at[i];
    });
    relocate();
  }
  function still() { cancelAnimationFrame(swinging); swinging = 0; }
  function swing(name) {
    const i = scene?.coordinates.findIndex(c => c.name === name) ?? -1;
    if (i < 0) return false;
    still();
    const c = scene.coordinates[i], began = performance.now(), first = at[i];
    const reach = Math.max(c.low, Math.min(c.high, first));
    const start = Math.asin(Math.max(-1, Math.min(1, (2 * reach - c.low - c.high) / (c.high - c.low || 1))));
    const step = time => {
      const turns = (time - began) / 4000;
      if (turns >= 1) { swinging = 0; return move(at.map((v, k) => k === i ? first : v)); }
      const s = Math.sin(start + 2 * Math.PI * turns);
      move(at.map((v, k) => k === i ? (c.low + c.high) / 2 + s * (c.high - c.low) / 2 : v), "swing");
      swinging = requestAnimationFrame(step);
    };
    swinging = requestAnimationFrame(step);
    return true;
  }
  function makeSliders() {
    rows = [];
    sliders.replaceChildren();
    scene.coordinates.forEach((c, i) => {
      if (c.circumstance) return;
      const set = v => { if (Number.isFinite(v)) move(at.map((x, k) => k === i ? v : x)); };
      const range = h("input", { type: "range", min: c.low, max: c.high, step: "any", "aria-label": `${c.name} (${c.unit})`, oninput: e => set(+e.target.value) });
      range.addEventListener("keydown", e => {
        const by = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[e.key];
        if (!by) return;
        e.preventDefault();
        set(Math.max(c.low, Math.min(c.high, +range.value + by * (c.high - c.low) / 100)));
      });
      const input = h("input", { type: "number", step: "any", "aria-label": `${c.name} (${c.unit}), as a number`, onchange: e => set(+e.target.value) });
      sliders.append(h("div", { class: "row" }, h("label", {}, c.name), h("span", { class: "limit" }, number(c.low)), range, h("span", { class: "limit" }, number(c.high)),
        input, h("span", {}, unitText(c.unit)), h("button", { type: "button", "aria-label": `swing ${c.name}`, title: "swing to and fro", onclick: () => swinging ? still() : swing(c.name) }, "⇄")));
      rows.push({ i, range, input });
    });
  }
  const shape = s => JSON.stringify([s.coordinates.map(c => [c.name, c.low, c.high, c.unit]), s.frames.length]);
  return {
    get scene() { return scene; },
    get coordinates() { return at; },
    get values() { return viewer?.values; },
    get viewer() { return viewer; },
    // Another model, or the same with other numbers: where it can the picture keeps its side.
    show(next, values) {
      const same = scene && shape(scene) === shape(next), kept = same ? at : null;
      scene = next;
      if (!viewer) {
        viewer = createViewer(view, scene, { values });
        viewer.onpick = onpick;
        viewer.visible(visible);
      } else {
        viewer.scene(scene, values);
      }
      if (!same) {
        still();
        at = scene.coordinates.map(c => c.rest);
        makeSliders();
        viewer.frame([values]);
      }
      move(kept ?? at, "scene");
    },
    move: coordinates => move(coordinates),
    set: (name, value) => move(at.map((v, i) => scene.coordinates[i].name === name ? value : v)),
    swing, visibly,
    highlight: key => viewer?.highlight(key),
  };
}

// Consecutive axes in words, and where each frame is, for the panel of equations.
export function axesTable(scene, values) {
  const format = (v, f, unit) => `${number(v / f, 5)} ${unit}`;
  return consecutive(scene, values).map(p => [scene.axes[p.first].joint, scene.axes[p.second].joint,
    format(p.angle, scene.angle.factor, scene.angle.unit), format(p.distance, scene.length.factor, scene.length.unit)]);
}
export { axisLine, origin };
