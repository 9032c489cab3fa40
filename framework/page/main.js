// The page: data and functions are in it, put there by the command that wrote it.
import "uplot/dist/uPlot.min.css";
import "./page.css";
import { makePanel } from "./panel.js";
import * as parts from "./sections.js";
import { makeStore, unpack } from "./store.js";

const data = unpack(JSON.parse(document.getElementById("data").textContent));
const store = makeStore(data, window.talusLinkages);
parts.verdict(data);
const panel = makePanel(document.getElementById("panel"), store), main = document.getElementById("main");
for (const part of [parts.findings(store), parts.located(store), parts.residuals(store), parts.axes(store), parts.parameters(store),
                    parts.unseen(store, panel), parts.suspects(store), parts.nextPoses(store, panel), parts.source(store)])
  if (part) main.append(part);
parts.footer(store);
if (store.poseCount() > 0) store.setPose(0);
panel.update();
panel.viewer.fit();
// On paper some of what is folded away is shown; nothing else can unfold it there.
let unfolded = null;
function onPaper(on) {
  if (on === Boolean(unfolded)) return;
  if (on) unfolded = [...document.querySelectorAll("details.paper:not([open])")];
  for (const part of unfolded) part.open = on;
  if (!on) unfolded = null;
}
matchMedia("print").addEventListener("change", e => onPaper(e.matches));
addEventListener("beforeprint", () => onPaper(true));
addEventListener("afterprint", () => onPaper(false));
// For tests and for those who want to look further.
window.talus = { store, panel, data };
