// The page in a browser: it moves the linkage exactly as C++ does, its charts have the right points, it
// works by keyboard, without WebGL and without a network, and nothing is written to the console.
import { cpSync, readFileSync, readdirSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { check, close, csv, folder, frames, launch, open, report, root, talus } from "../support/browser.mjs";

const near = (a, b, tolerance) => Math.abs(a - b) <= tolerance * Math.max(1, Math.abs(b));
const dataOf = file => JSON.parse(/<script type="application\/json" id="data">(.*?)<\/script>/s.exec(readFileSync(join(folder, file), "utf8"))[1]);

// Every frame of the model at random poses: C++ against what the page works out.
async function moves(browser, model, poses = 12) {
  talus("check", model, "--html", "model.html");
  const page = await open(browser, "model.html", { hash: "#flat" });
  const worst = await frames(model, dataOf("model.html").linkages[0], poses, asked => page.evaluate(asked => asked.map(list => {
    const { store } = window.talus;
    store.setAll(store.scene, list);
    return [...window.talus.panel.viewer.values];
  }), asked));
  await close(page);
  return worst;
}

cpSync(join(root, "models"), join(folder, "models"), { recursive: true });
const browser = await launch();

// All shipped models, in XML and Lua, with joints and effects written in Lua; and one with effects.
const isl = join(folder, "models/isl-bonny-2013/model.xml");
writeFileSync(join(folder, "models/isl-bonny-2013/effects.xml"), readFileSync(isl, "utf8").replace("</talus>",
  '<encoder_eccentricity at="encoder3" cosine="0.3" sine="0.2"/><encoder_second_harmonic at="encoder2" cosine="0.1" sine="0.05"/></talus>'));
const models = readdirSync(join(folder, "models"), { recursive: true }).filter(f => /(model\.xml|model\.lua|scripted\.xml|effects\.xml)$/.test(f)).sort();
let worst = 0;
for (const model of models) worst = Math.max(worst, await moves(browser, "models/" + model));
console.log(`${models.length} models: frames agree with C++ within ${worst.toExponential(1)}`);

// A calibration: sliders, charts, keyboard.
talus("calibrate", isl, "models/isl-bonny-2013/concealed.csv", "--html", "fit.html", "--out", "out", "--quiet");
const data = dataOf("fit.html"), scene = data.linkages[0];
const page = await open(browser, "fit.html");
check("WebGL is used", await page.evaluate(() => window.talus.panel.viewer.kind) === "webgl");
check("the verdict is there", (await page.locator(".headline").textContent()).length > 20);
check("held-out figures come first", /held out/.test(await page.locator("#verdict p:not(.headline)").first().textContent()));

const calibrated = readdirSync(join(folder, "out")).find(f => f.endsWith("-calibrated.xml"));
check("the calibrated model was written", Boolean(calibrated));
const number = page.locator(".sliders input[type=number]");
check("one slider for each coordinate", await number.count() === scene.coordinates.length);
await page.locator("#state").selectOption("0");
const angles = [11, -23, 31, 17, -41, 7];
for (let i = 0; i < angles.length; ++i) {
  await number.nth(i).fill(String(angles[i]));
  await number.nth(i).dispatchEvent("change");
}
const grid = scene.coordinates.map((c, i) => `${c.name}=${angles[i]}`).join("; ");
const tip = csv(talus("motion", isl, "--grid", grid, "--frame", "E in B"));
const shown = await page.evaluate(() => [...window.talus.panel.viewer.values]), E = scene.frames.findIndex(f => f.label === "E" || f.name === "E");
["x", "y", "z"].forEach((axis, i) =>
  check(`the sliders move E.${axis} as C++ does`, near(shown[scene.frames[E].at + 4 * i + 3], tip.rows[0][tip.head.indexOf("E." + axis)], 1e-9)));
await page.locator("#reset").click();
const slider = page.locator(".sliders input[type=range]").first();
const before = +await number.first().inputValue();
await slider.focus();
await page.keyboard.press("ArrowRight");
check("a slider moves by keyboard", +await number.first().inputValue() > before);

await page.locator("#state").selectOption("1");
for (const measure of data.report.baseline.measures) {
  await page.locator("#measure").selectOption(measure.name);
  const points = await page.evaluate(() => {
    const { series, columns } = window.talusCharts.residuals.data;
    return series.map((s, i) => [s.label, columns[i]]);
  });
  const held = points.find(([label]) => /calibrated, held out/.test(label))[1].filter(v => v !== null);
  const rms = Math.sqrt(held.reduce((sum, v) => sum + v * v, 0) / held.length);
  check(`the chart of ${measure.name} has ${measure.count} held-out points (${held.length})`, held.length === measure.count);
  check(`their root mean square is the report's: ${rms}, ${measure.rmse}`, near(rms / measure.rmse, 1, 1e-3));
}
await page.locator("#against").selectOption({ label: "theta3" });
await page.locator("#residuals").focus();
await page.keyboard.press("ArrowRight");
await page.keyboard.press("ArrowRight");
const theta3 = data.columns.find(c => c.name === "theta3").values, order = theta3.map((v, k) => k).sort((a, b) => theta3[a] - theta3[b] || a - b);
check("the chart's arrow keys go along its axis", await page.evaluate(() => window.talus.store.pose) === order[1]);
const spot = await page.evaluate(() => {
  const { chart, data } = window.talusCharts.residuals, list = data.columns.findLast(c => c.some(v => v !== null)), k = list.findIndex(v => v !== null);
  const box = chart.over.getBoundingClientRect();
  return { x: box.left + chart.valToPos(data.columns[0][k], "x"), y: box.top + chart.valToPos(list[k], "y"), k };
});
await page.mouse.move(spot.x, spot.y);
await page.mouse.click(spot.x, spot.y);
check("a point chosen in the chart is the pose shown", await page.evaluate(() => window.talus.store.pose) === order[spot.k]);
const row = await page.evaluate(() => window.talus.store.pose);
check("and its readings are on the sliders", near(+await number.nth(2).inputValue(), theta3[row], 1e-4));
await page.locator("#parameters tbody tr", { hasText: "joint3.a" }).first().click();
check("a parameter lights its joint", await page.evaluate(() => window.talus.store.lit) === "joint:joint3");
check("and its line of the model", /joint3/.test(await page.locator(".source .lit").first().textContent()));
// The legend has values where there are some: of the pose chosen, none where no pose is.
const legend = () => page.locator("#residuals .u-legend .u-value").evaluateAll(list => list.filter(e => e.offsetParent).map(e => e.textContent));
check(`the legend tells the pose chosen (${await legend()})`, near(+(await legend())[0].replace("−", "-"), theta3[row], 1e-3));
await page.mouse.move(5, 5);
await page.locator("#reset").click();
check(`and nothing where none is (${await legend()})`, (await legend()).length === 0);
check("names of units are not broken", await page.locator("#parameters td.s").evaluateAll(list => list.length > 5 && list.every(e => e.clientHeight < 30)));
check("labels of the chart's axes fit", await page.evaluate(() => {
  const { axes, bbox, ctx } = window.talusCharts.residuals.chart;
  ctx.font = axes[1].labelFont[0];
  return axes[1].label.length > 3 && ctx.measureText(axes[1].label).width <= bbox.height;
}));
// By keyboard: a line of the model, the picture.
const line = page.locator(".source [data-key='joint:joint4']").first();
await line.focus();
await page.keyboard.press("Enter");
check("Enter on a line lights its joint", await page.evaluate(() => window.talus.store.lit) === "joint:joint4");
const seenAt = () => page.evaluate(() => window.talus.panel.viewer.project([100, 0, 0])[0]), seen = await seenAt();
await page.locator(".viewer").focus();
await page.keyboard.press("ArrowLeft");
check("arrow keys turn the picture", await seenAt() !== seen);
check("the size is modest", statSync(join(folder, "fit.html")).size < 1.2e6);
await close(page);

// Dark, paper; without WebGL.
const dark = await open(browser, "fit.html", { hash: "#flat", colorScheme: "dark" });
await dark.emulateMedia({ media: "print" });
check("paper is light", await dark.evaluate(() => getComputedStyle(document.body).backgroundColor) === "rgb(255, 255, 255)");
check("nothing is wider than the paper", await dark.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
await close(dark);
await browser.close();
const without = await launch("--disable-3d-apis");
const plain = await open(without, "fit.html");
check("without WebGL a flat canvas is used", await plain.evaluate(() => window.talus.panel.viewer.kind) === "canvas");
const ink = await plain.evaluate(() => {
  const canvas = document.querySelector(".viewer canvas"), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let n = 0;
  for (let i = 0; i < data.length; i += 4) n += data[i] + data[i + 1] + data[i + 2] < 720;
  return n / (data.length / 4);
});
check(`and the linkage is on it (${ink})`, ink > 0.003);
await close(plain);

// A diagnosis of two thousand poses: small, with the poses and residuals of all its states.
writeFileSync(join(folder, "models/isl-bonny-2013/one.xml"), readFileSync(isl, "utf8").replace("</talus>", '<encoder_eccentricity at="encoder3" cosine="0.3" sine="0.2"/></talus>'));
talus("simulate", "models/isl-bonny-2013/one.xml", "--poses", "2000", "--recordings", "many.csv");
talus("diagnose", isl, "many.csv", "--html", "many.html", "--out", "out", "--quiet");
const size = statSync(join(folder, "many.html")).size;
check(`a diagnosis of 2,000 poses takes less than 2 MB (${size})`, size < 2e6);
const many = await open(without, "many.html");
await many.locator("#pose").focus();
await many.keyboard.press("End");
check("and the last is shown", await many.evaluate(() => window.talus.store.pose) === 1999);
const states = await many.evaluate(() => window.talus.data.states.map(s => ({ label: s.label, poses: s.coordinates.map(list => list.length), offsets: s.offsets.E.length,
  heldout: s.rows.map(r => Math.sqrt(r.residuals.filter((_, k) => window.talus.data.use[k] === "c").reduce((sum, v, _, { length }) => sum + v * v / length, 0))) })));
check(`nominal, before and after are in it (${states.map(s => s.label)})`, states.length === 3 && states.every(s => s.poses.length === 6 && s.poses.every(n => n === 2000) && s.offsets === 6));
const all = dataOf("many.html").report;
[all.baseline, all.after].forEach((fit, i) => fit.measures.forEach((m, r) =>
  check(`${states[i + 1].label}: RMSE of ${m.name} is the report's: ${states[i + 1].heldout[r]}, ${m.rmse}`, near(states[i + 1].heldout[r] / m.rmse, 1, 1e-3))));
check("nominal is worse", states[0].heldout[0] > 3 * states[1].heldout[0]);
const kept = csv(readFileSync(join(folder, "many.csv"), "utf8"));
check("the recordings are as they were read", await many.evaluate(([name, values]) => window.talus.data.columns.find(c => c.name === name).values.every((v, k) => v === values[k]),
  ["theta3", kept.rows.map(row => row[kept.head.indexOf("theta3")])]));
await without.close();

// What was found: its curve, its parameters; suspects on paper.
const again = await launch(), found = await open(again, "many.html", { hash: "#flat" });
const curves = await found.evaluate(() => window.talus.data.curves);
check(`the curve has narrow bins (${curves[0].length})`, curves[0].length > 12 && curves[0].reduce((n, p) => n + p.count, 0) > 1000);
check("of equal counts", Math.max(...curves[0].map(p => p.count)) - Math.min(...curves[0].map(p => p.count)) <= 1);
check("and a band narrower than a bin's noise, yet a band", curves[0].every(p => p.fitted_std > 0 && p.fitted_std < p.std));
check("the fitted effect goes through what was asked for", curves[0].filter(p => Math.abs(p.after) < 3 * p.std).length > 0.9 * curves[0].length && curves[0].some(p => Math.abs(p.before) > 20 * p.std));
const drawn = await found.evaluate(() => {
  const canvas = document.querySelector(".curve canvas"), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let n = 0;
  for (let i = 0; i < data.length; i += 4) n += data[i] > 200 && data[i + 1] < 120 && data[i + 2] < 60 && data[i + 3] > 200;  // the line's colour
  return n;
});
check(`it is drawn (${drawn})`, drawn > 200);
check("few parameters stand open", await found.locator("#findings details").count() === 0 && await found.locator("#findings td", { hasText: "amplitude" }).count() > 0);
const verdicts = media => found.emulateMedia({ media }).then(() => found.locator("#suspects .tall tbody tr").evaluateAll(list => list.filter(e => e.offsetParent).map(e => e.children[2].textContent)));
const screen = await verdicts("screen"), paper = await verdicts("print"), count = (list, word) => list.filter(w => w === word).length;
check(`all suspects are on the screen (${screen.length})`, screen.length === all.sensitivity.length && count(screen, "rejected") > 10);
check(`ten rejected ones on paper (${count(paper, "rejected")})`, count(paper, "rejected") === 10);
check("and all others", paper.length - 10 === screen.length - count(screen, "rejected") && count(paper, "found") > 0);
check("paper says so", await found.locator("#suspects .onpaper").isVisible());
const errors = found.locator("#residuals-part details table").first();
const becomes = (locator, state) => locator.waitFor({ state, timeout: 20000 }).then(() => true, () => false);
check("what measures err by is unfolded on paper", await becomes(errors, "visible"));
await found.emulateMedia({ media: "screen" });
check("and folded again", await becomes(errors, "hidden") && await found.locator("#suspects .onpaper").isHidden());
// A pose to record next, a direction that is not seen, the recording as a film.
const values = () => found.evaluate(() => [...window.talus.panel.viewer.values]);
const differ = (a, b) => a.some((v, i) => Math.abs(v - b[i]) > 1e-6);
let was = await values();
await found.locator("#next .card").nth(1).focus();
await found.keyboard.press("Enter");
check("a pose to record next is shown", differ(was, await values()));
was = await values();
const play = found.locator("#unseen button").first();
check("there is something that is not seen", await play.count() === 1);
await play.click();
const range = was.map(v => [v, v]);
for (let i = 0; i < 20; ++i) {  // a swing takes 4.4 seconds
  (await values()).forEach((v, k) => { range[k] = [Math.min(range[k][0], v), Math.max(range[k][1], v)]; });
  await found.waitForTimeout(120);
}
const turned = await found.evaluate(() => window.talus.store.scene.frames.flatMap(f => [0, 1, 2, 4, 5, 6, 8, 9, 10].map(i => f.at + i)));
check("it moves", range.some(([low, high]) => high - low > 0.01));
check("and not out of sight", turned.every(i => range[i][1] - range[i][0] < 0.75));
await play.click();
await found.locator(".pose button").click();
let reached = 0;
for (let i = 0; i < 100 && !reached; ++i, await found.waitForTimeout(100)) reached = await found.evaluate(() => +document.querySelector("#pose").value);
check("the recording plays", reached > 0);
await close(found);

// A curve of many parameters: folded away, and on paper left out.
const heights = Array.from({ length: 20 }, (_, i) => `unknown_reading_encoder3.c${i + 1}`), told = dataOf("many.html");
told.report.findings[0].parameters = heights.map(name => ({ name: name.split(".")[1], value: 0.1, unit: "deg", std: 0.01 }));
told.report.after.parameters.push(...heights.map(name => ({ ...told.report.after.parameters[0], name })));
writeFileSync(join(folder, "heights.html"), readFileSync(join(folder, "many.html"), "utf8").replace(/(id="data">).*?(<\/script>)/s, (_, a, b) => a + JSON.stringify(told).replaceAll("<", "\\u003c") + b));
const curved = await open(again, "heights.html", { hash: "#flat" });
check("many heights are folded away", await curved.locator("#findings details", { hasText: "20 parameters" }).count() === 1 && await curved.locator("#findings td", { hasText: "c20" }).isHidden());
check("on the screen they are parameters", await curved.locator("#parameters td", { hasText: "encoder3.c20" }).isVisible());
await curved.emulateMedia({ media: "print" });
check("on paper they are not", await curved.locator("#parameters td", { hasText: "encoder3.c20" }).isHidden() && await curved.locator("#parameters td", { hasText: "joint3.a" }).first().isVisible());
await close(curved);

// `axes` of several recordings: each can be chosen, in the chart and in the picture.
const ankle = (file, grid, deviation) => talus("simulate", "models/ankle-storey-2006/scripted.xml", "--grid", grid, "--recordings", file, "--set", "talocrural.inclination=11",
  "--set", `talocrural.deviation=${deviation}`, "--set", "subtalar.inclination=48", "--set", "subtalar.deviation=31");
ankle("intact.csv", "q1=-20:30:5; q2=-15:15:5", 80);
ankle("changed.csv", "q1=-20:30:5; q2=-15:15:10", 82);
talus("axes", "models/ankle-storey-2006/model.xml", "intact.csv", "changed.csv", "--html", "axes.html", "--quiet");
const axes = await open(again, "axes.html", { hash: "#flat" });
const inChart = () => axes.evaluate(() => window.talusCharts.residuals.data.columns[1].filter(v => v !== null).length);
const [intact, changed] = ["intact.csv", "changed.csv"].map(name => csv(readFileSync(join(folder, name), "utf8")).rows.length);
check("the first recording comes first", await inChart() === intact);
await axes.locator("#recording").selectOption({ label: "changed.csv" });
check(`the other can be chosen (${await inChart()})`, await inChart() === changed && changed < intact);
check("and is the one in the picture", await axes.locator("#state").evaluate(e => e.selectedOptions[0].textContent) === "changed.csv" && +await axes.locator("#pose").getAttribute("max") === changed - 1);
check("its columns are those of its file", await axes.locator("#against option", { hasText: "E.x" }).count() === 1);
check("each can be had as CSV", await axes.locator("#footer button", { hasText: "changed.csv (CSV)" }).count() === 1);
await close(axes);

// What --set changes is said beside the source.
talus("check", isl, "models/isl-bonny-2013/concealed.csv", "--set", "joint2.a=300 ?", "--set", "calibrate.residual=position", "--html", "set.html");
const set = await open(again, "set.html", { hash: "#flat" });
check("changes are told", /joint2\.a = 300 \?.*calibrate\.residual = position/s.test(await set.locator("#changes").textContent()));
check("and their lines marked", (await set.locator(".source .set").allTextContents()).map(text => /joint2.*set: joint2\.a = 300 \?/s.test(text) || /calibrate.*set: calibrate\.residual/s.test(text)).join() === "true,true");
await close(set);
check("nothing is marked without", !/class="set"|by --set/.test(await (await open(again, "fit.html", { hash: "#flat" })).locator("#source").innerHTML()));

// A linkage whose axes meet in one point, which measures a direction: its arrow is in the picture.
talus("check", "models/mount-altaz/model.xml", "--html", "mount.html");
const mount = await open(again, "mount.html", { hash: "#flat" });
const tips = await mount.evaluate(() => {
  const { store, panel: { viewer } } = window.talus, { clientWidth, clientHeight } = document.querySelector(".viewer");
  return store.scene.features.filter(f => f.kind === "direction").map(f => {
    const [x, y] = viewer.project([0, 1, 2].map(i => viewer.values[f.at + 4 * i + 3] + 13 * viewer.values[f.at + 4 * i + 2]));
    return x > 0 && y > 0 && x < clientWidth && y < clientHeight;
  });
});
check("a direction's arrow is in the picture", tips.length > 0 && tips.every(Boolean));
await close(mount);

// How far away a root is that does not fit into the picture can be read from all sides.
talus("check", "models/arm-6r/model.xml", "--html", "arm.html");
const arm = await open(again, "arm.html", { hash: "#flat" });
for (const view of ["front", "side", "top", "oblique"]) {
  await arm.locator("#panel button", { hasText: view }).click();
  await arm.waitForTimeout(300);
  const inside = await arm.evaluate(() => {
    const stage = document.querySelector(".viewer").getBoundingClientRect();
    return [...document.querySelectorAll(".names .note:not([hidden])")].map(e => e.getBoundingClientRect()).map(b => b.left >= stage.left && b.right <= stage.right && b.top >= stage.top && b.bottom <= stage.bottom);
  });
  check(`${view}: the distance of the root is in the picture`, inside.length === 1 && inside[0]);
}
await again.close();

// What a page is without a browser's scripts, and what must not be in it.
const html = readFileSync(join(folder, "fit.html"), "utf8");
check("no address is loaded from", !/(src|href)="https?:/.test(html));
check("no text is turned into code", !/unsafe-eval/.test(html) && /script-src 'unsafe-inline';/.test(html));
check("the report is there as text", /<pre>[^<]*Parameters/s.test(html));
report(`; a diagnosis of 2,000 poses: ${(size / 1e6).toFixed(2)} MB`);
