// recorded_test.mjs CHROMIUM WEB_BUILD_FOLDER OUT: the page of a recorded run, OUT/report/index.html.
import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";
import { join } from "node:path";

const [chromiumPath, web, out] = process.argv.slice(2);
const { chromium } = createRequire(join(web, "package.json"))("playwright-core");
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
if (process.getuid() === 0) args.push("--no-sandbox");
const browser = await chromium.launch({ executablePath: chromiumPath, args });
const page = await browser.newPage({ viewport: { width: 1280, height: 1000 } });
const complaints = [];
page.on("console", (m) => m.type() === "error" && complaints.push(m.text()));
page.on("pageerror", (e) => complaints.push(e.message));
await page.goto(pathToFileURL(join(out, "report/index.html")).href);
assert.ok(await page.evaluate(() => window.brickbench.ready.then((r) => Boolean(r))));

// What the page shows of the recorded files.
const scene = await page.evaluate(async () => {
  const { stage } = await window.brickbench.ready;
  return {
    engines: stage.views.map(({ view }) => view.engine),
    bodies: stage.bodies.length,
    ends: stage.views.map(({ run }) => run.times[run.frames - 1]),
    frames: stage.views.map(({ run }) => run.frames),
    contacts: stage.views.map(({ run }) => (run.contacts ? run.contacts.points.length / 3 : 0)),
    // The lowest centre of a brick and the farthest contact point from the wall, over all frames.
    lowest: Math.min(...stage.views.map(({ run }) => Math.min(...run.positions.filter((_, i) =>
      i % 3 === 2 && stage.bodies[((i - 2) / 3) % run.bodies].role === "brick")))),
    highest: Math.max(...stage.views.map(({ run }) =>
      (run.contacts ? Math.max(...run.contacts.points.filter((_, i) => i % 3 === 2)) : 0))),
  };
});
const recorded = readdirSync(join(out, "results/trajectories")).filter((name) => name.endsWith(".h5"));
assert.equal(scene.engines.length, recorded.length);
assert.equal(new Set(scene.engines).size, recorded.length, "two views of one engine");
for (const end of scene.ends) assert.ok(Math.abs(end - 0.4) < 1e-6, `a run ends at ${end} s`);
for (const frames of scene.frames) assert.equal(frames, 51);
assert.ok(scene.contacts.some((count) => count > 500), `contact points: ${scene.contacts}`);
assert.ok(scene.lowest > 0 && scene.lowest < 0.06, `lowest brick at ${scene.lowest} m`);
assert.ok(scene.highest > 0.15 && scene.highest < 1, `highest contact at ${scene.highest} m`);
console.log(`ok   shows ${scene.engines.join(", ")}; contact points ${scene.contacts.join(", ")}`);

const pixels = () => page.evaluate(async () => {
  const { stage } = await window.brickbench.ready;
  stage.draw();
  const gl = stage.renderer.getContext();
  const bytes = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  return [...bytes.filter((_, i) => i % 4 === 1)];
});
const share = (a, b) => a.filter((v, i) => Math.abs(v - b[i]) > 8).length / a.length;
const seek = (time) => page.evaluate((t) => window.brickbench.clock.seek(t), time);
const start = await pixels();
await seek(0.3);
const hit = await pixels();
assert.ok(share(start, hit) > 0.002, "the hit moved nothing");
await page.getByRole("button", { name: "contact points" }).click();
assert.ok(share(hit, await pixels()) > 0.0005, "no contact points");
await page.getByRole("button", { name: "contact points" }).click();
console.log("ok   shows contact points");

// Depths are computed when the page is made: no more than a brick is thick, and of some brick at the hit.
const depths = await page.evaluate(() => window.brickbench.ready.then(({ stage }) =>
  stage.views.map(({ run }) => run.penetrations && run.penetrations.reduce((a, b) => Math.max(a, b), 0))));
for (const depth of depths) assert.ok(depth >= 0 && depth < 0.11, `${depth} m deep`);
assert.ok(depths.some((depth) => depth > 1e-4), `nobody sinks in: ${depths}`);
await page.getByLabel("colour by").selectOption("penetration");
assert.ok(share(hit, await pixels()) > 0.01, "no colour by penetration");
assert.match(await page.locator(".legend").textContent(), /^0.* m$/);
await page.getByLabel("colour by").selectOption("material");
console.log(`ok   colours by penetration, up to ${depths.map((d) => (1e3 * d).toFixed(2)).join(", ")} mm`);
await page.screenshot({ path: join(out, "page.png") });
const facts = await page.locator("#replay .quiet").textContent();
assert.match(facts, new RegExp(`^${recorded.length} of ${recorded.length} recorded cells; 51 of up to 51 recorded frames`));
assert.deepEqual(complaints, []);
await browser.close();
