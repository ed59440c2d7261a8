// page-facts.mjs CHROMIUM WEB_BUILD_FOLDER PAGE [PICTURES]: opens a report page in headless Chromium
// with software GL and prints one JSON object: its bytes, milliseconds to the drawn replay (median
// of three), requests, complaints, and frames per second of the replay with up to four views.
// PICTURES: an existing folder for pictures of the page: desktop, dark, phone, and each section.
import { statSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [chromiumPath, web, file, pictures] = process.argv.slice(2);
const { chromium } = createRequire(resolve(web, "package.json"))("playwright-core");
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
if (process.getuid() === 0) args.push("--no-sandbox");
const browser = await chromium.launch({ executablePath: chromiumPath, args });
const complaints = [];
const requests = new Set();

async function open(options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 1000 }, ...options });
  const page = await context.newPage();
  page.on("console", (m) => m.type() === "error" && complaints.push(m.text()));
  page.on("pageerror", (e) => complaints.push(e.message));
  page.on("request", (r) => r.url().startsWith("data:") || requests.add(r.url()));
  const began = performance.now();
  await page.goto(pathToFileURL(resolve(file)).href);
  const replay = await page.evaluate(() => window.brickbench.ready.then((r) => Boolean(r)));
  return { page, replay, load_ms: Math.round(performance.now() - began), close: () => context.close() };
}

const median = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];

// Plays the scene with the most bodies from its start for at least five seconds of wall time.
async function measureReplay(page) {
  return page.evaluate(async () => {
    const { stage, load } = await window.brickbench.ready;
    const { scenes } = window.brickbench.data;
    const work = (scene) => scene.bodies.length * Math.min(4, scene.views.length);
    const heaviest = scenes.indexOf(scenes.reduce((a, b) => (work(b) > work(a) ? b : a)));
    await load(heaviest);
    stage.host.scrollIntoView();
    const clock = window.brickbench.clock;
    clock.speed = clock.end / 8;
    clock.play(true);
    const wait = (ms) => new Promise((done) => setTimeout(done, ms));
    await wait(3000);  // the resolution settles
    const [frames, began] = [stage.frames, performance.now()];
    await wait(5000);
    const fps = (stage.frames - frames) / ((performance.now() - began) / 1000);
    clock.play(false);
    return { scene: scenes[heaviest].name, views: stage.visible.length,
      bodies_per_view: scenes[heaviest].bodies.length, frames_per_s: Number(fps.toFixed(1)),
      pixels_per_css_pixel: Number(stage.playRatio.toFixed(2)) };
  });
}

// The page from the top, and each section; the replay in the middle of its motion.
async function photograph(name, options) {
  const { page, replay, close } = await open(options);
  if (replay) {
    await page.evaluate(() => window.brickbench.ready.then(({ stage }) => {
      window.brickbench.clock.seek(0.5 * window.brickbench.clock.end);
      stage.draw();
    }));
  }
  const { width } = options.viewport;
  const shoot = (path, clip) => page.screenshot({ path, type: "jpeg", quality: 70, fullPage: true, clip });
  await page.waitForTimeout(300);
  await shoot(join(pictures, `${name}.jpg`), { x: 0, y: 0, width, height: Math.min(1900, 3 * width) });
  const sections = await page.evaluate(() => [...document.querySelectorAll("section")].map((s) => {
    const box = s.getBoundingClientRect();
    return { id: s.id, y: box.top + scrollY, height: box.height };
  }));
  for (const { y } of sections) await page.evaluate((top) => scrollTo(0, top), y);
  await page.waitForTimeout(500);
  for (const { id } of sections.filter((s) => /(time|validation)$/.test(s.id) && name === "desktop")) {
    const box = await page.evaluate((s) => {
      const r = document.getElementById(s).getBoundingClientRect();
      return { y: r.top + scrollY, height: r.height };
    }, id);
    await page.evaluate((top) => scrollTo(0, top), box.y);
    await page.waitForTimeout(500);
    await shoot(join(pictures, `${name}-${id}.jpg`),
      { x: 0, y: box.y, width, height: Math.min(1300, box.height) });
  }
  await close();
}

const loads = [];
let replay = null;
for (let i = 0; i < 3; ++i) {
  const opened = await open();
  loads.push(opened.load_ms);
  if (i === 2 && opened.replay) replay = await measureReplay(opened.page);
  await opened.close();
}
if (pictures) {
  await photograph("desktop", { viewport: { width: 1280, height: 1000 } });
  await photograph("dark", { viewport: { width: 1280, height: 1000 }, colorScheme: "dark" });
  await photograph("phone", { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true });
}
console.log(JSON.stringify({ page_bytes: statSync(file).size, load_ms: median(loads),
  requests: requests.size, complaints, replay }, null, 2));
await browser.close();
process.exit(complaints.length > 0 || requests.size > 1 ? 1 : 0);
