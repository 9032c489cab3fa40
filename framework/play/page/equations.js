// Each joint as a product of elementary motions, its matrix at the posture shown, and how
// consecutive axes stand to each other.
import { h, number, table, unitText, withStd } from "../../page/dom.js";
import { origin } from "../../page/linkage.js";
import { axesTable } from "./stage.js";

const product = motions => motions.length ? motions.flatMap(m => [h("span", { class: "together" }, m.kind === "matrix" ? `[${m.text}]`
  : `${m.kind === "R" ? "R" : "T"}${m.axis}(${m.text.replace(/ deg$/, "°")})`), " "]) : ["1"];

function matrixOf(scene, values, frame) {  // T_parent_frame from both in the root
  const b = scene.frames[frame].at, p = scene.frames[frame].parent, T = (at, i, j) => values[at + 4 * i + j];
  if (p < 0) return [0, 1, 2].map(i => [0, 1, 2, 3].map(j => T(b, i, j)));
  const a = scene.frames[p].at, shift = [0, 1, 2].map(i => T(b, i, 3) - T(a, i, 3));
  return [0, 1, 2].map(i => [0, 1, 2, 3].map(j => [0, 1, 2].reduce((sum, k) => sum + T(a, k, i) * (j < 3 ? T(b, k, j) : shift[k]), 0)));
}

export function equationsPanel({ onlight }) {
  const element = h("div", { class: "equations" });
  let numbers = [], scene = null, tip = null, apart = null;
  return {
    element,
    show(next) {
      scene = next;
      numbers = [];
      element.replaceChildren(h("p", { class: "note" }, "From frame to frame, left to right; R turns about an axis, T moves along it. Numbers are of the posture shown."));
      for (const e of scene.equations) {
        if (e.reading !== undefined) {
          element.append(h("p", { class: "equation" }, `A reading of ${e.reading} means `, h("code", {}, e.text)));
          continue;
        }
        const frame = scene.frames[e.frame], parent = scene.frames[e.parent], matrix = h("pre", { class: "matrix" });
        const key = "joint:" + frame.name;
        element.append(h("div", { class: "equation", tabindex: 0, onmouseenter: () => onlight(key), onmouseleave: () => onlight(null), onfocus: () => onlight(key), onblur: () => onlight(null) },
          h("span", {}, h("i", {}, "T"), h("sub", {}, `${parent.label}→${frame.label}`), " = ", h("code", {}, ...product(e.motions))), matrix));
        numbers.push({ frame: e.frame, matrix });
      }
      tip = h("p", { class: "note" });
      apart = h("div");
      element.append(tip, apart);
    },
    update(values) {
      if (!scene) return;
      for (const { frame, matrix } of numbers) {
        const text = matrixOf(scene, values, frame).map(row => row.map((v, j) =>
          (j < 3 ? v.toFixed(4) : (v / scene.length.factor).toFixed(2)).replace(/^-(0\.?0*)$/, "$1").padStart(j < 3 ? 8 : 10)).join("")).join("\n");
        if (matrix.textContent !== text) matrix.textContent = text;
      }
      const ends = scene.frames.map((f, i) => ({ f, i })).filter(({ i }) => i > 0 && !scene.frames.some(g => g.parent === i));
      tip.textContent = ends.map(({ f }) => `${f.label} in ${scene.frames[0].label}: ${origin(values, f.at).map(v => number(v / scene.length.factor, 6)).join(", ")} ${scene.length.unit}`).join("; ");
      const rows = axesTable(scene, values);
      apart.replaceChildren(...(rows.length ? [table([{ title: "axis", text: true }, { title: "next axis", text: true }, { title: "angle" }, { title: "shortest distance" }], rows)] : []));
    },
  };
}

export function parametersTable(parameters, fit) {
  const solved = new Map((fit?.parameters ?? []).map(p => [p.name, p]));
  const columns = [{ title: "parameter", text: true }, { title: "model" }, ...(fit ? [{ title: "solved" }, { title: "±" }] : [{ title: "tolerance" }]), { title: "", text: true }];
  return table(columns, parameters.map(p => {
    const s = solved.get(p.name);
    return [p.name, number(p.value, 7), ...(fit ? [s ? withStd(s.value, s.std) : "–", s?.std === null || s?.std === undefined ? "–" : number(s.std, 2)]
      : [p.tolerance === undefined ? "free" : number(p.tolerance, 4)]), unitText(p.unit) + (s && s.identifiable === false ? " · not seen" : "")];
  }));
}
