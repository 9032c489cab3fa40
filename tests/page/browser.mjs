// The page in a browser: it moves the linkage exactly as C++ does, its charts have the right points, it
// works by keyboard, without WebGL and without a network, and nothing is written to the console.
import { execFileSync } from "node:child_process";
import { cpSync, mkdtempSync, readFileSync, readdirSync, existsSync, statSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const root = join(dirname(fileURLToPath(import.meta.url)), "../.."), folder = process.argv[2];
const { chromium } = await import(join(root, "framework/page/node_modules/playwright-core/index.mjs"));
const talus = (...args) => execFileSync(process.env.TALUS, args, { cwd: folder, encoding: "utf8", maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "pipe"] });
let checks = 0, failures = 0;
function check(what, is) {
  ++checks;
  if (is) return;
  ++failures;
  console.log("FAILED:", what);
}
const near = (a, b, tolerance) => Math.abs(a - b) <= tolerance * Math.max(1, Math.abs(b));

// Patience: a machine may have other things to do.
const patience = 180000;
const launch = (...more) => chromium.launch({ executablePath: process.env.CHROMIUM, timeout: patience,
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage", ...more] });
async function open(browser, file, hash = "", options = {}) {
  const context = await browser.newContext({ offline: true, viewport: { width: 1400, height: 950 }, ...options });
  context.setDefaultTimeout(patience);
  const page = await context.newPage();
  page.on("console", m => check(`${file}: console says ${m.text()}`, !["error", "warning"].includes(m.type())));
  page.on("pageerror", e => check(`${file}: ${e.message}`, false));
  page.on("request", r => check(`${file} asks for ${r.url().slice(0, 80)}`, /^(file|blob|data):/.test(r.url())));
  await page.goto("file://" + join(folder, file) + hash, { timeout: patience });
  await page.locator("#footer p").first().waitFor();
  return page;
}

const csv = text => {
  const [head, ...rows] = text.split("\n").filter(line => line && !line.startsWith("#")).map(line => line.split(","));
  return { head: head.map(name => name.replace(/\[.*/, "")), rows: rows.map(row => row.map(Number)) };
};
const rotation = ([w, x, y, z]) => [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
  [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]];
const dataOf = file => JSON.parse(/<script type="application\/json" id="data">(.*?)<\/script>/s.exec(readFileSync(join(folder, file), "utf8"))[1]);

// Every frame of the model at random poses: C++ against what the page works out.
async function moves(browser, model, poses = 12) {
  talus("check", model, "--html", "model.html");
  const data = dataOf("model.html"), scene = data.linkages[0], frames = scene.frames.slice(1).map(f => f.name);
  const table = csv(talus("motion", model, "--poses", String(poses), "--seed", "7", ...frames.flatMap(name => ["--frame", `${name} in ${scene.frames[0].name}`])));
  const page = await open(browser, "model.html", "#flat");
  const asked = table.rows.map(row => scene.coordinates.map(c => {
    const i = table.head.indexOf(c.column) >= 0 ? table.head.indexOf(c.column) : table.head.indexOf(c.name);
    return i < 0 ? null : row[i];
  }));
  const values = await page.evaluate(asked => asked.map(list => {
    const { store } = window.talus;
    store.setAll(store.scene, list);
    return [...window.talus.panel.viewer.values];
  }), asked);
  let worst = 0;
  table.rows.forEach((row, k) => frames.forEach((name, f) => {
    const first = table.head.length - 7 * (frames.length - f), at = scene.frames[f + 1].at;
    const expected = rotation(row.slice(first + 3, first + 7)), mm = scene.length.factor;
    for (let i = 0; i < 3; ++i) {
      const p = row[first + i] * mm;
      worst = Math.max(worst, Math.abs(values[k][at + 4 * i + 3] - p) / Math.max(1, Math.abs(p)));
      for (let j = 0; j < 3; ++j) worst = Math.max(worst, Math.abs(values[k][at + 4 * i + j] - expected[i][j]));
    }
  }));
  check(`${model}: frames as C++ has them (off by ${worst})`, worst < 1e-9);
  check(`${model}: there are frames`, frames.length > 0 && table.rows.length === poses);
  await page.context().close();
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
check("the size is modest", statSync(join(folder, "fit.html")).size < 1.2e6);
await page.context().close();

// Dark, paper; without WebGL.
const dark = await open(browser, "fit.html", "#flat", { colorScheme: "dark" });
await dark.emulateMedia({ media: "print" });
check("paper is light", await dark.evaluate(() => getComputedStyle(document.body).backgroundColor) === "rgb(255, 255, 255)");
check("nothing is wider than the paper", await dark.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
await dark.context().close();
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
await plain.context().close();

// Two thousand poses.
talus("simulate", isl, "--poses", "2000", "--recordings", "many.csv");
talus("calibrate", isl, "many.csv", "--html", "many.html", "--out", "out", "--quiet", "--restarts", "0");
const size = statSync(join(folder, "many.html")).size;
check(`2,000 poses make less than 2 MB (${size})`, size < 2e6);
const many = await open(without, "many.html");
await many.locator("#pose").focus();
await many.keyboard.press("End");
check("and the last is shown", await many.evaluate(() => window.talus.store.pose) === 1999);
await without.close();

// What a page is without a browser's scripts, and what must not be in it.
const html = readFileSync(join(folder, "fit.html"), "utf8");
check("no address is loaded from", !/(src|href)="https?:/.test(html));
check("no text is turned into code", !/unsafe-eval/.test(html) && /script-src 'unsafe-inline';/.test(html));
check("the report is there as text", /<pre>[^<]*Parameters/s.test(html));
console.log(`${checks - failures} of ${checks} checks passed; 2,000 poses: ${(size / 1e6).toFixed(2)} MB`);
process.exit(failures ? 1 : 0);
