// Student mode: recordings of a linkage with something wrong that the model does not have. First
// by eye, then by the solver.
import { h } from "../../page/dom.js";
import { norm, origin, sub } from "../../page/linkage.js";
import list from "./faults.json";

// A small generator of its own, so that a number names the same exercise everywhere.
function random(seed) {
  let s = (seed * 2654435761 + 12345) >>> 0;
  return () => {
    s = (s + 0x6d2b79f5) >>> 0;
    let t = Math.imul(s ^ (s >>> 15), 1 | s);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

export function faultsPanel({ page, record, diagnose, editor }) {
  let planted = null;
  const number_ = h("input", { type: "number", min: 1, max: 9999, value: 1, "aria-label": "number of the exercise" });
  const size = h("select", { "aria-label": "how large" }, h("option", { value: 5 }, "large"), h("option", { value: 2.5 }, "middling"), h("option", { value: 1 }, "small"));
  const guess = h("select", { "aria-label": "your guess" }), words = h("p", { "aria-live": "polite" });
  const plantIt = h("button", { type: "button", id: "plant", onclick: plant }, "Plant a fault");
  const after = [guess, h("button", { type: "button", id: "guess", onclick: judge }, "That is it"), h("button", { type: "button", onclick: ask }, "Ask the solver"),
    h("button", { type: "button", onclick: reveal }, "Tell me")];
  const second = h("div", { class: "tools", hidden: true }, "I say", after);
  const element = h("div", {}, h("p", { class: "note" }, "A linkage like this one is recorded, but something is wrong with it that the model does not have. Look at the residuals against one coordinate after the other. Which place, and what?"),
    h("div", { class: "tools" }, "Exercise", number_, size, plantIt), second, words);

  const places = kind => kind === "sensor" ? page.scene.coordinates.filter((c, i) => !c.circumstance && page.scene.axes.some(a => a.coordinates.includes(i))
      && page.elements.some(e => e.name === c.name && e.tag !== "unknown")).map(c => c.name)
    : page.scene.axes.filter(a => a.coordinates.length && page.elements.some(e => e.name === a.joint)).map(a => a.joint);
  const loads = () => page.elements.some(e => e.tag === "gravity") && /\bmass="/.test(editor.text);
  // About the largest moment of gravity in this linkage, N m.
  function moment() {
    const masses = [...editor.text.matchAll(/\bmass="([\d.eE+-]+)/g)].reduce((sum, m) => sum + +m[1], 0);
    const points = page.scene.frames.map(f => origin(page.values, f.at)), reach = Math.max(...points.map(p => norm(sub(p, points[0]))));
    return 9.81 * masses * reach / 1000 / 2 || 1;
  }
  function candidates() {
    const known = new Map(page.plugins.filter(p => p.family === "effect").map(p => [p.name, p]));
    return list.filter(f => known.has(f.effect) && (!f.load || loads()))
      .flatMap(f => places(f.place).map(at => ({ ...f, at, plugin: known.get(f.effect) })));
  }
  const label = f => `${f.title} at ${f.at}`;
  async function plant() {
    const all = candidates();
    if (!all.length) { words.textContent = "This model has no sensor or joint at which a fault could be planted."; return; }
    const draw = random(+number_.value), fault = all[Math.floor(draw() * all.length)];
    const amounts = fault.amounts ?? fault.plugin.inputs.filter(i => i.role === "amount").map(i => i.name), turn = 2 * Math.PI * draw();
    const values = amounts.map((name, i) => {
      const input = fault.plugin.inputs.find(x => x.name === name), share = amounts.length === 2 ? (i ? Math.cos(turn) : Math.sin(turn)) : draw() < 0.5 ? -1 : 1;
      const sign = fault.positive ? 1 : share;
      const usual = fault.load ? 0.06 / moment() : fault.typical ?? input.typical ?? 0.1;  // 0.06 deg under its load
      return `${name}="${(+size.value * sign * usual).toPrecision(3)} ${fault.unit ?? input.unit}"`;
    });
    planted = { fault, text: `<${fault.effect} at="${fault.at}" ${values.join(" ")}/>` };
    words.textContent = "";
    const keep = all.map(label);
    guess.replaceChildren(...keep.map(k => h("option", {}, k)));
    second.hidden = false;
    await record({ poses: 80, seed: +number_.value, faults: `<talus>${planted.text}</talus>`, what: "of a linkage with a fault that the model does not have" });
  }
  function judge() {
    const right = guess.value === label(planted.fault), place = guess.value.endsWith(" at " + planted.fault.at);
    words.textContent = right ? "Yes. Ask the solver how large it is, or add it to the model yourself."
      : place ? "The place is right; what happens there is something else." : "No. Where do the residuals change with the coordinate, and with what period?";
  }
  async function ask() {
    const found = await diagnose();
    if (!found) return;
    const f = found.findings[0];
    words.textContent = f ? `The solver says: ${f.effect.replaceAll("_", " ")} at ${f.location}, ${f.values}.` : "The solver claims nothing.";
  }
  function reveal() { words.replaceChildren("Planted was ", h("code", {}, planted.text), ". ", planted.fault.hint); }
  return { element, get planted() { return planted; }, candidates,
    model() { if (planted && !page.recordings) { planted = null; second.hidden = true; words.textContent = ""; } } };
}
