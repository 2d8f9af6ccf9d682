// SPDX-License-Identifier: Apache-2.0
// report.html in headless Chromium: opens with no error and no request, shows one moment everywhere, obeys the keyboard.
//
// usage: node viewer_test.mjs GATEFLY ROOT      exit 77: skipped, something is missing here
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, rmSync, statSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [gatefly, root] = process.argv.slice(2);
const chromium = ["/usr/bin/chromium", "/usr/bin/google-chrome"].find((path) => existsSync(path));

function skip(why) {
  console.log(`viewer: skipped, ${why}`);
  process.exit(77);
}
if (!chromium) skip("no Chromium here (apt-get install chromium)");
let playwright;
try {
  playwright = createRequire(join(root, "viewer", "package.json"))("playwright-core");
} catch {
  skip("no playwright-core here (cd viewer && npm ci)");
}

const folder = mkdtempSync(join(tmpdir(), "gatefly-viewer-"));

/** A flight's page; whether it finished does not matter. */
function fly(name, ...args) {
  const out = join(folder, name);
  const run = spawnSync(gatefly, ["fly", ...args, "--quiet", "--out", out], { cwd: root, encoding: "utf-8" });
  assert.ok(run.status === 0 || run.status === 1, run.stderr);
  const page = join(out, "report.html");
  assert.ok(statSync(page).size <= 5_000_000);
  return page;
}

const browser = await playwright.chromium.launch({
  executablePath: chromium,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-quic"],
});

/** Opens a page and hands it to `check`; afterwards nothing must have been complained about or asked of a network. */
async function open(path, options, check) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  const complaints = [], requests = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && !/GPU stall|GL Driver/.test(message.text()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => /^(file|data):/.test(request.url()) || requests.push(request.url()));
  await page.goto(pathToFileURL(path).href);
  await page.waitForFunction(() => window.__report !== undefined);
  await check(page);
  assert.deepEqual(complaints, []);
  assert.deepEqual(requests, []);
  await context.close();
}

const state = (page) => page.evaluate(() => window.__report.state());
const settled = (page) => page.waitForTimeout(400);

/** Scene, plots, picture and table show the same moment. */
async function inStep(page, time, pictures) {
  await page.evaluate((t) => window.__report.clock.seek(t), time);
  await settled(page);
  const now = await state(page);
  const due = await page.evaluate((t) => {
    const { flight } = window.__report;
    const shown = flight.looks.filter((look) => look.t <= t && (look.picture !== undefined || !flight.pictures.length));
    return { row: Math.max(flight.t[0], ...Array.from(flight.t).filter((at) => at <= t)), look: shown.length ? shown[shown.length - 1].t : null };
  }, time);
  assert.equal(now.time, time);
  assert.equal(now.plots, time);
  assert.equal(now.scene, due.row);
  assert.equal(now.onboard?.look ?? null, due.look);
  if (pictures) assert.equal(now.onboard.picture, due.look);
  assert.match(await page.textContent("#clock"), new RegExp(`^${time.toFixed(2)} s$`));
}

const tests = {
  async "an ideal flight: one moment everywhere, the keyboard, a table that jumps"() {
    const path = fly("ideal", "oval", "--vision", "ideal", "--laps", "1");
    await open(path, { viewport: { width: 1280, height: 800 } }, async (page) => {
      assert.match(await page.textContent("#verdict"), /^Finished, 2 of 2 gates/);
      const { end } = await page.evaluate(() => ({ end: window.__report.clock.end }));
      for (const time of [0, 3.21, 0.5 * end, end]) await inStep(page, time, false);

      await page.keyboard.press("Home");
      assert.equal((await state(page)).time, 0);
      await page.keyboard.press("Shift+ArrowRight");
      await page.keyboard.press("ArrowRight");
      assert.ok(Math.abs((await state(page)).time - 1.1) < 1e-9);
      await page.keyboard.press("ArrowLeft");
      assert.ok(Math.abs((await state(page)).time - 1.0) < 1e-9);
      await page.keyboard.press("Space");
      await settled(page);
      await page.keyboard.press("Space");
      const played = await state(page);
      assert.ok(!played.playing && played.time > 1.1, `played to ${played.time}`);
      await page.keyboard.press("End");
      assert.equal((await state(page)).time, end);

      const passed = await page.evaluate(() => window.__report.flight.passes[1].t);
      await page.click("#gates tbody tr:nth-child(2) button");
      assert.equal((await state(page)).time, passed);

      await page.locator(".plot .u-over").first().scrollIntoViewIfNeeded();
      const box = await page.locator(".plot .u-over").first().boundingBox();
      await page.mouse.click(box.x + box.width / 2, box.y + 10);
      assert.ok(Math.abs((await state(page)).time - end / 2) < 0.02 * end);
    });
  },

  async "a rendered flight that is lost: what went wrong is on the first screen, pictures in step"() {
    const path = fly("lost", "oval", "--laps", "1", "--set", "sim.timeout_s=5");
    await open(path, { viewport: { width: 1280, height: 800 }, colorScheme: "dark" }, async (page) => {
      assert.match(await page.textContent("#verdict"), /^Timed out/);
      const chip = page.locator(".chip.bad");
      assert.ok((await chip.boundingBox()).y < 800);
      await chip.click();
      assert.ok((await state(page)).time >= 3.9);
      for (const time of [2.5, 4.03]) await inStep(page, time, true);
    });
  },

  async "a phone: nothing to scroll sideways, everything can be reached by the keyboard"() {
    await open(join(folder, "ideal", "report.html"), { viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true }, async (page) => {
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
      const reached = new Set();
      for (let i = 0; i < 40; ++i) {
        await page.keyboard.press("Tab");
        reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.className || document.activeElement.dataset.view));
      }
      for (const id of ["theme", "play", "time", "rate", "link"]) assert.ok(reached.has(id), `${id} of ${[...reached]}`);
    });
  },

  async "interactive at once"() {
    const context = await browser.newContext();
    const times = [];
    for (let i = 0; i < 3; ++i) {
      const page = await context.newPage();
      const begin = performance.now();
      await page.goto(pathToFileURL(join(folder, "ideal", "report.html")).href);
      await page.waitForFunction(() => window.__report !== undefined);
      times.push(performance.now() - begin);
      await page.close();
    }
    console.log(`  ${times.map((time) => time.toFixed(0)).join(", ")} ms`);
    assert.ok(Math.min(...times) <= 2000);
    await context.close();
  },
};

let failed = 0;
try {
  for (const [name, test] of Object.entries(tests)) {
    try {
      await test();
      console.log(`ok: ${name}`);
    } catch (error) {
      ++failed;
      console.log(`FAILED: ${name}\n${error.stack}`);
    }
  }
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failed ? 1 : 0);
