// What tests of pages in a real browser share: checks that are counted, the command, a browser, a page
// opened from disk with the network off, whose console must stay quiet.
import { execFileSync } from "node:child_process";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

export const root = join(dirname(fileURLToPath(import.meta.url)), "../.."), folder = process.argv[2];
const { chromium } = await import(join(root, "framework/page/node_modules/playwright-core/index.mjs"));
export const talus = (...args) => execFileSync(process.env.TALUS, args, { cwd: folder, encoding: "utf8", maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "pipe"] });

let checks = 0, failures = 0;
export function check(what, is) {
  ++checks;
  if (is) return;
  ++failures;
  console.log("FAILED:", what);
}
export function report(more = "") {
  console.log(`${checks - failures} of ${checks} checks passed${more}`);
  process.exit(failures ? 1 : 0);
}

// Patience: a machine may have other things to do.
const patience = 240000;
export const launch = (...more) => chromium.launch({ executablePath: process.env.CHROMIUM, timeout: patience,
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage", ...more] });
// `ready`: a selector of what is there when the page is.
export async function open(browser, file, { hash = "", ready = "#footer p", ...options } = {}) {
  const context = await browser.newContext({ offline: true, viewport: { width: 1400, height: 950 }, ...options });
  context.setDefaultTimeout(patience);
  const page = await context.newPage();
  page.on("console", m => check(`${file}: console says ${m.text()}`, !["error", "warning"].includes(m.type())));
  page.on("pageerror", e => check(`${file}: ${e.message}`, false));
  page.on("request", r => check(`${file} asks for ${r.url().slice(0, 80)}`, /^(file|blob|data):/.test(r.url())));
  await page.goto("file://" + join(folder, file) + hash, { timeout: patience });
  await page.locator(ready).first().waitFor();
  return page;
}
export const close = page => page.context().close();

// What `talus motion` says of all frames at random poses, and what a page has there: the worst
// difference, of lengths relative where they are large. valuesAt(lists of coordinates) -> lists of values.
export async function frames(model, scene, poses, valuesAt) {
  const names = scene.frames.slice(1).map(f => f.name);
  const table = csv(talus("motion", model, "--poses", String(poses), "--seed", "7", ...names.flatMap(name => ["--frame", `${name} in ${scene.frames[0].name}`])));
  const asked = table.rows.map(row => scene.coordinates.map(c => {
    const i = table.head.indexOf(c.column) >= 0 ? table.head.indexOf(c.column) : table.head.indexOf(c.name);
    return i < 0 ? null : row[i];
  }));
  const values = await valuesAt(asked);
  let worst = 0;
  table.rows.forEach((row, k) => names.forEach((name, f) => {
    const first = table.head.length - 7 * (names.length - f), at = scene.frames[f + 1].at;
    const expected = rotation(row.slice(first + 3, first + 7)), mm = scene.length.factor;
    for (let i = 0; i < 3; ++i) {
      const p = row[first + i] * mm;
      worst = Math.max(worst, Math.abs(values[k][at + 4 * i + 3] - p) / Math.max(1, Math.abs(p)));
      for (let j = 0; j < 3; ++j) worst = Math.max(worst, Math.abs(values[k][at + 4 * i + j] - expected[i][j]));
    }
  }));
  check(`${model}: frames as the command has them (off by ${worst})`, worst < 1e-9);
  check(`${model}: there are frames`, names.length > 0 && table.rows.length === poses);
  return worst;
}

export const csv = text => {
  const [head, ...rows] = text.split("\n").filter(line => line && !line.startsWith("#")).map(line => line.split(","));
  return { head: head.map(name => name.replace(/\[.*/, "")), rows: rows.map(row => row.map(Number)) };
};
const rotation = ([w, x, y, z]) => [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
  [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]];
