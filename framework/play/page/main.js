// The teaching page: a model's text beside the linkage that it makes; its equations, the residuals
// of recordings, and the solver, all in the page.
import { h, number } from "../../page/dom.js";
import { covariates, residualChart } from "../../page/charts.js";
import { coreOf, startCore } from "./core.js";
import { createEditor } from "./editor.js";
import { equationsPanel, parametersTable } from "./equations.js";
import { faultsPanel } from "./faults.js";
import { lessons, lessonView } from "./lessons.js";
import { makeStage } from "./stage.js";
import "./play.css";

const $ = id => document.getElementById(id), given = JSON.parse($("given").textContent.trim() || "null");
const page = { scene: null, elements: [], parameters: [], recordings: null, fit: null, before: null, lesson: null, plugins: [] };
let core = null, files = {}, timer = 0, version = 0;

const status = text => { $("status").textContent = text; };
const ask = (request, seconds) => core.ask(request, seconds);

// ---- the parts of the page
const editor = createEditor($("editor"), { onchange: () => { clearTimeout(timer); timer = setTimeout(readNow, 150); }, online: lightLine });
const equations = equationsPanel({ onlight: key => stage.highlight(key) });
const stage = makeStage($("stage"), {
  locate: async coordinates => {
    const { values } = await ask({ do: "pose", coordinates });
    return values?.map(v => v ?? NaN);
  },
  onpick: key => {
    const name = key?.startsWith("joint:") ? key.slice(6) : key?.startsWith("frame:") ? page.scene.frames[+key.slice(6)]?.name : null;
    const element = page.elements.find(e => e.name === name && e.file === editor.file);
    stage.highlight(element ? key : null);
    editor.light(element?.line ?? 0, true);
  },
  onpose: (values, coordinates) => {
    equations.update(values);
    chart.mark(poseAt(coordinates));
  },
});
// Residuals of the model as it stands and, where the solver has been asked, with its answer.
const chart = residualChart({ height: 240, onpose: k => stage.move(posesOf().map(list => list[k])) });
const posesOf = () => (chart.content?.before ?? chart.content?.after)?.coordinates ?? [];
const poseAt = coordinates => posesOf()[0]?.findIndex((_, k) => posesOf().every((list, i) => list[k] === null || list[k] === coordinates[i])) ?? -1;
function judged(...states) {
  const [first, second = null] = states;
  chart.show(!first ? null : { before: second && first, after: second ?? first, what: second && "both",
    against: covariates("pose", [], page.scene, first.coordinates) });
}
const parameters = h("div"), verdict = h("div", { class: "verdict", "aria-live": "polite" }), known = h("p", { class: "note" });
const tool = (text, f, attributes = {}) => h("button", { type: "button", onclick: f, ...attributes }, text);
const poses = h("input", { type: "number", min: 5, max: 2000, value: 60, "aria-label": "poses to simulate" });
const cancel = tool("Stop", () => core.stop("stopped"), { hidden: true });
const open = h("input", { type: "file", accept: ".csv,.trc", hidden: true, onchange: async e => {
  const file = e.target.files[0];
  if (file) await record(await file.text(), file.name, "your recordings");
  open.value = "";
} });
const solving = h("div", { class: "tools" },
  tool("Simulate", () => simulate({ poses: +poses.value }), { title: "Recordings of this very model, with the noise that it states" }), poses, "poses",
  tool("Open CSV …", () => open.click()), open,
  tool("Calibrate", calibrate, { id: "calibrate" }), tool("Diagnose", diagnose, { id: "diagnose" }), cancel,
  tool("Take over the answer", () => { if (page.answer) editor.set(page.answer); }, { id: "take", hidden: true }));
const faults = faultsPanel({ page, record: hidden => simulate(hidden), diagnose, editor });
$("below").append(
  h("section", { id: "residuals" }, h("h2", {}, "Residuals and solver"), solving, known, verdict, chart.element, parameters),
  h("section", { id: "faults" }, h("h2", {}, "Find the fault"), faults.element),
  h("section", { id: "equations" }, h("h2", {}, "Equations"), equations.element));

function lightLine(line) {
  const element = page.elements.filter(e => e.file === editor.file && e.line <= line).at(-1);
  const here = element?.line === line ? element : null;
  const frame = here && page.scene?.frames.findIndex(f => f.name === here.name);
  stage.highlight(!here?.name ? null : page.scene.axes.some(a => a.joint === here.name) ? "joint:" + here.name : frame > 0 ? "frame:" + frame : null);
}
function problem(error) {
  const here = !error || error.file === editor.file || !error.file;
  editor.error(error && here ? error : null);
  $("problem").hidden = !error;
  $("problem").textContent = error ? `${[here ? "" : error.file, error.line ? `line ${error.line}` : ""].filter(Boolean).join(", ")}${error.line ? ": " : ""}${error.text}` : "";
  document.body.classList.toggle("stale", Boolean(error));
}

// ---- reading and judging
async function readNow() {
  const mine = ++version, answer = await ask({ do: "read", text: editor.text, file: editor.file }, 5);
  if (mine !== version) return false;
  if (answer.ended) await remember();
  problem(answer.error);
  if (answer.error) { status("The picture is of the last model that could be read."); return false; }
  Object.assign(page, { scene: answer.scene, elements: answer.elements, parameters: answer.parameters, values: answer.values, fit: null, answer: null });
  $("take").hidden = true;
  equations.show(page.scene);
  stage.show(page.scene, answer.values.map(v => v ?? NaN));
  parameters.replaceChildren(...(page.parameters.length ? [parametersTable(page.parameters)] : []));
  faults.model();
  status(`${page.scene.name}: ${page.scene.coordinates.filter(c => !c.circumstance).length} coordinates, ${page.parameters.length} free parameters.`);
  verdict.replaceChildren();
  await judge();
  return true;
}
// The residuals of the model as it stands.
async function judge() {
  if (!page.recordings) { judged(); known.textContent = "There are no recordings yet: simulate some, open a file, or plant a fault below."; return; }
  const mine = version, answer = await ask({ do: "residuals" }, 20);
  if (mine !== version) return;
  if (answer.error) { judged(); known.textContent = `Residuals: ${answer.error.text}`; page.state = null; return; }
  page.state = answer.state;
  known.textContent = `${page.recordings.what}. ${answer.rms === null ? "" : `As it stands, the model leaves ${number(answer.rms, 3)} stated sigmas (1 is what the instruments explain).`}`;
  judged({ ...answer.state, label: "model" });
}
async function remember() {  // to a core that has just been started
  if (page.recordings) await ask({ do: "record", text: page.recordings.text, file: page.recordings.file });
}
async function record(text, file, what) {
  const answer = await ask({ do: "record", text, file });
  if (answer.error) { known.textContent = `${file}: ${answer.error.line ? `line ${answer.error.line}: ` : ""}${answer.error.text}`; return false; }
  page.recordings = { text, file, what: `${answer.poses} poses, ${what}` };
  return readNow();
}
async function simulate({ poses = 60, seed = 1, noise = 1, faults = "", text = null, what = "simulated from the model" }) {
  if (text !== null || page.scene === null) {  // of another model than the one in the editor
    const read = await ask({ do: "read", text: text ?? editor.text, file: text === null ? editor.file : "hidden.xml" }, 5);
    if (read.error) return problem(read.error), false;
  }
  const answer = await ask({ do: "simulate", poses, seed, noise, faults }, 60);
  if (answer.error) { known.textContent = answer.error.text; return false; }
  return record(answer.recordings, "simulated.csv", what);
}
async function solve(request, word) {
  if (!page.recordings) { known.textContent = "There are no recordings to solve for: simulate some, or open a file."; return null; }
  clearTimeout(timer);
  if (page.fit === undefined || !(await readNow())) return null;
  const mine = version, began = performance.now();
  verdict.replaceChildren(h("p", { class: "busy" }, `${word} …`));
  cancel.hidden = false;
  const answer = await ask(request);
  cancel.hidden = true;
  if (answer.ended) { await remember(); await readNow(); }
  if (mine !== version) return null;
  if (answer.error) { verdict.replaceChildren(h("p", {}, answer.error.text)); return null; }
  answer.seconds = (performance.now() - began) / 1000;
  page.answer = answer.model;
  $("take").hidden = false;
  return answer;
}
async function calibrate() {
  const fit = await solve({ do: "calibrate" }, "Calibrating");
  if (!fit) return null;
  page.fit = fit;
  verdict.replaceChildren(h("p", { class: "headline" }, `${fit.verdict.headline}.`), ...fit.verdict.sentences.map(w => h("p", {}, w)),
    h("p", { class: "note" }, `${fit.iterations} iterations, ${number(fit.seconds, 2)} s.`),
    ...[...fit.warnings, ...fit.unidentifiable].map(w => h("p", { class: "note" }, w)));
  parameters.replaceChildren(parametersTable(page.parameters, fit));
  judged({ ...page.state, label: "model" }, { ...fit.state, label: "calibrated" });
  return fit;
}
async function diagnose() {
  const found = await solve({ do: "diagnose" }, "Looking for what the model leaves out");
  if (!found) return null;
  verdict.replaceChildren(h("p", { class: "headline" }, found.sentence), ...found.findings.map(f => h("p", {}, f.sentence)),
    ...(found.heldout ? [h("p", {}, found.heldout)] : []), ...found.hints.map(f => h("p", { class: "note" }, "Hint. " + f.sentence)),
    h("p", { class: "note" }, `${number(found.seconds, 2)} s in this page. “Take over the answer” puts the extended model into the editor.`));
  judged({ ...found.before_state ?? page.state, label: found.before_state ? "calibrated" : "model" }, { ...found.state, label: "with what was found" });
  return found;
}

// ---- lessons, and the file that the page was made for
const hash = () => decodeURIComponent(location.hash.slice(1));
async function begin(id) {
  const lesson = lessons.find(l => l.id === id) ?? null;
  page.lesson = lesson;
  page.recordings = null;
  await ask({ do: "record", text: "" });
  for (const b of $("lessons").querySelectorAll("button")) b.setAttribute("aria-pressed", String(b.dataset.id === (lesson?.id ?? "")));
  $("lesson").hidden = !lesson;
  if (lesson) {
    $("lesson").replaceChildren(lessonView(lesson, act));
    $("lesson").scrollTop = 0;
    page.source = { text: lesson.model, file: lesson.file };
  } else {
    page.source = given ?? { text: lessons[0].model, file: lessons[0].file };
  }
  $("file").replaceChildren(h("span", {}, page.source.file), tool("As it was", () => editor.set(page.source.text)),
    tool("Save …", () => save(page.source.file, editor.text)));
  editor.set(page.source.text, page.source.file);
  clearTimeout(timer);
  if (!lesson && given?.recordings) await record(given.recordings.text, given.recordings.file, `from ${given.recordings.file}`);
  else await readNow();
}
function save(name, text) {
  const url = URL.createObjectURL(new Blob([text], { type: "text/plain" })), link = h("a", { href: url, download: name.split("/").at(-1) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}
// What a link of a lesson does: "set joint1.a=200", "move encoder1=40", ...
async function act(words) {
  const [verb, ...rest] = words.split(" "), argument = rest.join(" ");
  const [, name, value] = /^([^=]*)=(.*)$/.exec(argument) ?? [];
  switch (verb) {
    case "set": {
      const dot = name.lastIndexOf(".");
      return editor.attribute(name.slice(0, dot), name.slice(dot + 1), value);
    }
    case "add": return editor.add(argument);
    case "move": return stage.set(name, +value);
    case "rest": return stage.move(page.scene.coordinates.map(c => c.rest));
    case "swing": return stage.swing(argument);
    case "axes": return stage.visibly({ apart: argument !== "off" });
    case "frames": return stage.visibly({ frames: argument === "off" ? true : "all" });
    case "record": return simulate({ text: page.lesson.model, ...page.lesson.hidden });
    case "chart": { const [m, a] = argument.split(" "); return chart.choose(m, a); }
    case "calibrate": return calibrate();
    case "diagnose": return diagnose();
    case "start": return begin(page.lesson.id);
    default: throw new Error(`a lesson's link does not know '${verb}'`);
  }
}

async function start() {
  files = given?.files ?? {};
  try {
    core = startCore(await coreOf(document), files);
  } catch (error) {
    return status(`The core cannot be run in this browser: ${error.message}`);
  }
  const grammar = await ask({ do: "grammar" });
  if (grammar.error) return status(grammar.error.text);
  page.plugins = grammar.plugins;
  editor.grammar(grammar.plugins);
  $("lessons").append(...(given ? [tool("Your model", () => begin(""), { "data-id": "" })] : []),
    ...lessons.map((l, i) => tool(`${i + 1}. ${l.title}`, () => begin(l.id), { "data-id": l.id })));
  await begin(lessons.some(l => l.id === hash()) ? hash() : given ? "" : lessons[0].id);
  document.body.dataset.ready = "yes";
}
globalThis.talusPlay = { page, stage, editor, chart, ask: request => ask(request), act, begin, faults, readNow };  // for tests
start();
