// page_test.mjs CHROMIUM WEB_BUILD_FOLDER OUT: the report page as a reader uses it.
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";
import { join } from "node:path";

const [chromiumPath, web, out] = process.argv.slice(2);
const { chromium } = createRequire(join(web, "package.json"))("playwright-core");
const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
if (process.getuid() === 0) args.push("--no-sandbox");
const browser = await chromium.launch({ executablePath: chromiumPath, args });

// A fresh page; complaints and requests are collected and judged at the end of each test.
async function open(name, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 1000 }, ...options });
  const page = await context.newPage();
  const complaints = [];
  const requests = [];
  page.on("console", (m) => m.type() === "error" && complaints.push(m.text()));
  page.on("pageerror", (e) => complaints.push(e.message));
  page.on("request", (r) => r.url().startsWith("data:") || requests.push(r.url()));
  const began = Date.now();
  await page.goto(pathToFileURL(join(out, "pages", name, "index.html")).href);
  await page.evaluate(() => window.brickbench.ready.then((r) => Boolean(r)));
  const loaded = Date.now() - began;
  return { page, complaints, requests, loaded, close: () => context.close() };
}

const seek = (page, t) => page.evaluate(async (time) => {
  const { stage } = await window.brickbench.ready;
  window.brickbench.clock.seek(time);
  stage.draw();
  // Plots follow in a later frame, however slow the machine is.
  for (let frame = 0; frame < 2; ++frame) await new Promise(requestAnimationFrame);
}, t);

// The picture of the stage as bytes.
const pixels = (page) => page.evaluate(async () => {
  const { stage } = await window.brickbench.ready;
  stage.draw();
  const gl = stage.renderer.getContext();
  const bytes = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  return bytes.filter((_, i) => i % 4 === 1).join(" ");
});
const difference = (a, b) => {
  const [x, y] = [a.split(" "), b.split(" ")];
  assert.equal(x.length, y.length, "the stage changed its size");
  return x.filter((v, i) => Math.abs(v - y[i]) > 8).length / x.length;
};
// A share of the pixels that no rounding of the renderer reaches.
const visible = 0.002;

const tests = {
  async "opens without complaint or request"() {
    const { page, complaints, requests, loaded, close } = await open("wall");
    await page.screenshot({ path: join(out, "screenshots/desktop.png") });
    await page.evaluate(() => window.brickbench.drawAllPlots());
    await page.waitForTimeout(300);
    await page.screenshot({ path: join(out, "screenshots/desktop-whole.png"), fullPage: true });
    assert.deepEqual(complaints, []);
    assert.equal(requests.length, 1, requests.join(" "));
    console.log(`  loaded in ${loaded} ms`);
    await close();
  },

  async "draws bricks in every view"() {
    const { page, close } = await open("wall");
    const colours = await page.evaluate(async () => {
      const { stage } = await window.brickbench.ready;
      stage.draw();
      const gl = stage.renderer.getContext();
      const { columns, rows } = stage.layout;
      const [w, h] = [gl.drawingBufferWidth / columns, gl.drawingBufferHeight / rows];
      return stage.visible.map((_, place) => {
        const bytes = new Uint8Array(4 * Math.floor(w) * Math.floor(h));
        gl.readPixels((place % columns) * w, Math.floor(place / columns) * h, Math.floor(w),
          Math.floor(h), gl.RGBA, gl.UNSIGNED_BYTE, bytes);
        return new Set(bytes.filter((_, i) => i % 4 === 0)).size;
      });
    });
    assert.equal(colours.length, 4);
    for (const count of colours) assert.ok(count > 20, `only ${count} shades in a view`);
    await close();
  },

  async "plays, pauses, scrubs and steps"() {
    const { page, complaints, close } = await open("wall");
    await page.locator(".stage").scrollIntoViewIfNeeded();
    await page.evaluate(() => window.brickbench.ready.then(({ stage }) => (stage.adaptive = false)));
    const start = await pixels(page);
    await page.getByRole("button", { name: "Play" }).click();
    await page.waitForFunction(() => window.brickbench.clock.time > 0.3, null, { timeout: 30000 });
    await page.getByRole("button", { name: "Pause" }).click();
    assert.ok(difference(start, await pixels(page)) > visible, "playing moved nothing");
    const stopped = await page.evaluate(() => window.brickbench.clock.time);
    await page.waitForTimeout(300);
    assert.equal(await page.evaluate(() => window.brickbench.clock.time), stopped);
    await page.getByLabel("time").fill("1.5");
    assert.equal(await page.evaluate(() => window.brickbench.clock.time), 1.5);
    const before = await page.evaluate(() => window.brickbench.clock.time);
    await page.locator(".stage").focus();
    await page.keyboard.press("ArrowRight");
    assert.ok((await page.evaluate(() => window.brickbench.clock.time)) > before, "no step on");
    await page.keyboard.press("ArrowLeft");
    await page.keyboard.press("ArrowLeft");
    assert.ok((await page.evaluate(() => window.brickbench.clock.time)) < before, "no step back");
    await page.keyboard.press("Home");
    assert.ok(difference(start, await pixels(page)) < visible, "the start looks different now");
    assert.deepEqual(complaints, []);
    await close();
  },

  async "orbits, zooms and has sides"() {
    const { page, close } = await open("wall");
    const stage = page.locator(".stage");
    await stage.scrollIntoViewIfNeeded();
    const start = await pixels(page);
    const box = await page.locator(".stage canvas").boundingBox();
    await page.mouse.move(box.x + 200, box.y + 120);
    await page.mouse.down();
    await page.mouse.move(box.x + 320, box.y + 150, { steps: 4 });
    await page.mouse.up();
    const turned = await pixels(page);
    assert.ok(difference(start, turned) > visible, "dragging turned nothing");
    await page.mouse.wheel(0, -400);
    await page.waitForTimeout(200);
    assert.ok(difference(turned, await pixels(page)) > visible, "the wheel zoomed nothing");
    const seen = [];
    for (const name of ["front", "side", "top", "three-quarter"]) {
      await page.getByRole("button", { name, exact: true }).click();
      const picture = await pixels(page);
      for (const other of seen) assert.ok(difference(other, picture) > visible, `${name} is no new side`);
      seen.push(picture);
    }
    assert.ok(difference(start, seen[3]) < visible, "three-quarter is not what the page opens with");
    await close();
  },

  async "colours, follows and shows a ghost"() {
    const { page, close } = await open("wall");
    await seek(page, 0.6);
    const plain = await pixels(page);
    await page.getByLabel("colour by").selectOption("displacement");
    const coloured = await pixels(page);
    assert.ok(difference(plain, coloured) > visible, "no colour by displacement");
    assert.match(await page.locator(".legend").textContent(), /^0.* m$/);
    await page.getByLabel("colour by").selectOption("speed");
    assert.ok(difference(coloured, await pixels(page)) > visible, "no colour by speed");
    await page.getByLabel("colour by").selectOption("material");
    await page.getByLabel("ghost").selectOption("3");
    assert.ok(difference(plain, await pixels(page)) > visible, "no ghost");
    await page.getByLabel("ghost").selectOption("-1");
    await page.getByRole("button", { name: "follow projectile" }).click();
    assert.ok(difference(plain, await pixels(page)) > visible, "the camera does not follow");
    await close();
  },

  async "every plot has data, axes with units, and a title"() {
    const { page, close } = await open("wall");
    await page.evaluate(() => window.brickbench.drawAllPlots());
    const plots = await page.evaluate(() => window.brickbench.data.figures.map((figure) => {
      const host = document.querySelector(`[data-figure="${figure.id}"]`);
      const canvas = host?.querySelector("canvas");
      const shades = canvas ? new Set(canvas.getContext("2d")
        .getImageData(0, 0, canvas.width, canvas.height).data).size : 0;
      return { id: figure.id, ready: host?.dataset.ready, title: host?.querySelector(".plot-title")?.textContent,
        x: figure.x.text, y: figure.y.text, shades,
        points: figure.curves.map((c) => c.y.filter((v) => v !== null).length) };
    }));
    assert.ok(plots.length >= 3, `${plots.length} plots`);
    for (const plot of plots) {
      assert.equal(plot.ready, "true", plot.id);
      assert.ok(plot.title, plot.id);
      assert.match(plot.x, /\(.+\)$|per simulated second$/, plot.id);
      assert.ok(plot.y, plot.id);
      assert.ok(plot.points.every((n) => n > 0), plot.id);
      assert.ok(plot.shades > 16, `${plot.id} is blank`);
    }
    await close();
  },

  async "plots and replay share their time"() {
    const { page, close } = await open("wall");
    await page.evaluate(() => window.brickbench.drawAllPlots());
    const plot = page.locator("figure[data-figure^=time]").first();
    await plot.scrollIntoViewIfNeeded();
    await page.waitForTimeout(200);
    const values = () => plot.locator(".u-legend").textContent();
    await seek(page, 0.2);
    const early = await values();
    await seek(page, 1.6);
    assert.notEqual(await values(), early, "the plot does not follow the replay");
    const over = await plot.locator(".u-over").boundingBox();
    await page.mouse.move(over.x + over.width / 2, over.y + over.height / 2);
    await page.mouse.move(over.x + over.width / 2 + 2, over.y + over.height / 2);
    const time = await page.evaluate(() => window.brickbench.clock.time);
    assert.ok(Math.abs(time - 1) < 0.1, `the replay is at ${time} s, not near 1 s`);
    await close();
  },

  async "shows in replay and plots since when a run is not to be trusted"() {
    const { page, complaints, close } = await open("flagged");
    await page.evaluate(() => window.brickbench.drawAllPlots());
    const labels = page.locator(".view-label");
    const marked = () => labels.evaluateAll((all) => all.map((label) => label.classList.contains("flagged")));
    assert.match(await labels.nth(1).textContent(), /! unsolved in 31 of 2000 steps from step 500/);
    assert.match(await labels.nth(2).textContent(), /blown_up: after step 1000/);
    assert.equal(await labels.nth(0).locator("small").count(), 0);
    await seek(page, 0.49);
    assert.deepEqual(await marked(), [false, false, false]);
    await page.getByRole("button", { name: "! 0.500 s" }).click();
    assert.ok(Math.abs(await page.evaluate(() => window.brickbench.clock.time) - 0.5) < 1e-9);
    assert.deepEqual(await marked(), [false, true, false]);
    const plot = page.locator("figure[data-figure^=time]").first();
    await plot.scrollIntoViewIfNeeded();
    await page.waitForTimeout(200);
    assert.match(await plot.locator(".u-legend").textContent(), /bee\/default !/);
    assert.match(await plot.locator("figcaption").textContent(), /No curve of gone\/default \(blown_up\)/);
    // The cross: opaque colour of the curve around its point, where the curve itself is faint.
    const opaque = (id) => page.evaluate((figureId) => {
      const figure = window.brickbench.data.figures.find((f) => f.id === figureId);
      const curve = figure.curves.find((c) => c.flagged_from !== undefined);
      const wanted = curve.colour.match(/[0-9a-f]{2}/gi).map((v) => parseInt(v, 16));
      const canvas = document.querySelector(`[data-figure="${figureId}"] canvas`);
      const { data: bytes } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      let count = 0;
      for (let i = 0; i < bytes.length; i += 4) {
        count += bytes[i + 3] > 200 && wanted.every((v, k) => Math.abs(v - bytes[i + k]) < 12) ? 1 : 0;
      }
      return count;
    }, id);
    const cross = await opaque(await plot.getAttribute("data-figure"));
    assert.ok(cross > 15 && cross < 400, `a cross of ${cross} points`);
    await page.locator("#replay").scrollIntoViewIfNeeded();
    await page.screenshot({ path: join(out, "screenshots/flagged.png"), fullPage: true });
    assert.deepEqual(complaints, []);
    await close();
  },

  async "is readable on a phone and in the dark"() {
    const { page, complaints, close } = await open("wall", {
      viewport: { width: 390, height: 800 }, colorScheme: "dark", hasTouch: true, isMobile: true });
    await page.screenshot({ path: join(out, "screenshots/phone-dark.png"), fullPage: true });
    const [content, window_, background] = await page.evaluate(() => [
      document.documentElement.scrollWidth, innerWidth, getComputedStyle(document.body).backgroundColor]);
    assert.ok(content <= window_, `${content} px wide in ${window_} px`);
    assert.ok(background.match(/\d+/g).every((v) => Number(v) < 80), background);
    assert.deepEqual(complaints, []);
    await close();
  },

  async "loads two thousand bricks"() {
    const { page, complaints, loaded, close } = await open("many");
    const bodies = await page.evaluate(() => window.brickbench.data.scenes[0].bodies.length);
    assert.ok(bodies >= 2000);
    const start = await pixels(page);
    await seek(page, 1.0);
    assert.ok(difference(start, await pixels(page)) > visible);
    assert.deepEqual(complaints, []);
    console.log(`  loaded in ${loaded} ms`);
    await close();
  },

  async "lists the licences of what it embeds"() {
    const { page, close } = await open("hostile");
    const text = await page.locator("details", { hasText: "Licences of the scripts" }).locator("pre").textContent();
    for (const module of ["three", "uplot"]) assert.match(text, new RegExp(`^${module}$`, "mi"));
    assert.ok(text.match(/Permission is hereby granted/g).length >= 2, "a licence is missing");
    await close();
  },

  async "shows hostile texts as texts"() {
    const { page, complaints, requests, close } = await open("hostile");
    await page.evaluate(() => window.brickbench.drawAllPlots());
    await page.waitForTimeout(300);
    assert.notEqual(await page.title(), "owned");
    assert.match(await page.locator("h1").textContent(), /^<script>document\.title='owned'<\/script>&"'$/);
    assert.equal(await page.locator("main b").count(), 0);
    assert.deepEqual(complaints, []);
    assert.equal(requests.length, 1);
    await close();
  },
};

let failed = 0;
for (const [name, test] of Object.entries(tests)) {
  try {
    await test();
    console.log(`ok   ${name}`);
  } catch (error) {
    ++failed;
    console.log(`FAIL ${name}\n     ${error.message}`);
  }
}
await browser.close();
console.log(`${Object.keys(tests).length - failed} of ${Object.keys(tests).length} passed`);
process.exit(failed === 0 ? 0 : 1);
