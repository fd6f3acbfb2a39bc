// SPDX-License-Identifier: Apache-2.0
// Tests the report of a map in a browser, opened as a file. FLOORLOC_BIN: folder of the programs; FLOORLOC_SCREENSHOTS:
// folder for screenshots.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, statSync } from "node:fs";
import { after, before, beforeEach, afterEach, test } from "node:test";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

import { makeReport } from "./product.js";

const ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
  "--disable-background-networking", "--disable-component-update", "--disable-sync"];

let report;
let numbers;
let browser;
let page;
let page_errors;
let requests;

before(async () => {
  report = makeReport();
  numbers = JSON.parse(readFileSync(join(report.folder, "report.json"), "utf8"));
  browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ARGUMENTS });
});

after(async () => {
  await browser?.close();
  report?.remove();
});

beforeEach(async () => {
  page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  page_errors = [];
  requests = [];
  page.on("pageerror", (error) => page_errors.push(error.message));
  page.on("console", (message) => page_errors.push(message.text()));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(pathToFileURL(join(report.folder, "report.html")).href);
});

afterEach(async () => {
  await page.close();
  assert.deepEqual(page_errors, []);
  assert.deepEqual(requests.filter((url) => !url.startsWith("file:") && !url.startsWith("data:")), []);
  assert.equal(requests.filter((url) => url.startsWith("file:")).length, 1, "the page is one file");
});

async function takeScreenshot(name) {
  const folder = process.env.FLOORLOC_SCREENSHOTS;
  if (folder) {
    mkdirSync(folder, { recursive: true });
    await page.screenshot({ path: join(folder, `${name}.png`), fullPage: true });
  }
}

const onMap = (layer) => page.locator(`#on-map-${layer}`);
const shown = (layer) => onMap(layer).evaluate((element) => getComputedStyle(element).display !== "none");
const viewBox = () => page.locator("#map").evaluate((map) => map.getAttribute("viewBox").split(" ").map(Number));

test("says first whether to trust the map, and why", async () => {
  assert.equal(await page.locator("[data-verdict]").getAttribute("data-verdict"), numbers.verdict);
  assert.equal(await page.locator("#verdict h2").textContent(), numbers.headline);
  const text = await page.locator("#verdict").textContent();
  for (const sentence of [...numbers.reasons, ...numbers.facts]) {
    assert.ok(text.includes(sentence), sentence);
  }
  await takeScreenshot("report");
});

test("shows every figure with the numbers of report.json", async () => {
  for (const section of ["verdict", "resurvey", "map-section", "layers-section", "held-out", "geometry", "exposure",
    "dropped", "origin"]) {
    assert.equal(await page.locator(`section#${section}`).count(), 1, section);
  }
  const tile = async (name) => (await page.locator(`[data-number="${name}"]`).textContent());
  assert.match(await tile("frames"), new RegExp(`^${numbers.map.frames}of ${numbers.build.frames}$`));
  assert.ok((await tile("held-out")).includes(`${numbers.held_out.localized} of ${numbers.held_out.frames}`));
  assert.ok((await tile("area")).startsWith(numbers.floor.surveyed_m2.toFixed(2)));
  assert.ok(numbers.held_out.frames > 0, "frames were held out");
  for (const layer of ["zones", "usable", "coverage", "density", "distinct", "links", "poses", "drift", "held_out"]) {
    assert.equal(await onMap(layer).count(), 1, layer);
    assert.equal(await page.locator(`.gallery [data-show="${layer}"] svg`).count(), 1, layer);
  }
  const mosaic = await page.locator("#mosaic image").getAttribute("href");
  assert.ok(mosaic.startsWith("data:image/jpeg;base64,"));
  assert.ok(statSync(join(report.folder, "report.html")).size < 4e6);
});

test("the hole of the survey is to be surveyed again, and marked on the mosaic", async () => {
  assert.ok(numbers.resurvey.length > 0);
  const [first] = numbers.resurvey;
  assert.equal(first.reason, "not_surveyed");
  const distance = Math.hypot(first.x - report.hole.x, first.y - report.hole.y);
  assert.ok(distance < 0.2, `${distance} m beside the hole`);
  assert.equal(await page.locator("[data-zone-row]").count(), numbers.resurvey.length);
  const map = await page.locator("#map").boundingBox();
  for (const zone of numbers.resurvey) {
    const mark = page.locator(`#map .mark[data-zone="${zone.number}"]`);
    const box = await mark.boundingBox();
    assert.equal(await mark.textContent(), String(zone.number));
    assert.ok(box.width > 12 && box.x > map.x && box.x + box.width < map.x + map.width && box.y > map.y &&
      box.y + box.height < map.y + map.height, `mark ${zone.number} is on the map`);
    // The mark is at the position in the list, converted by the browser, which knows the image's scale.
    const [x, y] = await page.locator("#map").evaluate((svg, [px, py]) => {
      const p = new DOMPoint(px, py).matrixTransform(svg.getScreenCTM().inverse());
      return [p.x, -p.y];
    }, [box.x + box.width / 2, box.y + box.height / 2]);
    assert.ok(Math.hypot(x - zone.x, y - zone.y) < 0.02, `mark ${zone.number} is at ${x}, ${y}`);
  }
});

test("layers can be switched", async () => {
  assert.equal(await shown("zones"), true);
  assert.equal(await shown("links"), false);
  await page.check("#layers input[value=links]");
  assert.equal(await shown("links"), true);
  assert.equal(await page.locator("#legend-links").isVisible(), true);
  await page.uncheck("#layers input[value=links]");
  assert.equal(await shown("links"), false);
  await page.check("#layers input[value=coverage]");
  await page.check("#layers input[value=density]");
  assert.equal(await shown("coverage"), false, "one colour at a time");
  assert.equal(await shown("density"), true);
  await page.uncheck("#layers input[value=marks]");
  assert.equal(await shown("marks"), false);
  await page.click(".gallery [data-show=usable]");
  assert.equal(await shown("usable"), true);
  await takeScreenshot("report-layers");
});

test("the map moves, and says what is under the pointer", async () => {
  const [, , width] = await viewBox();
  await page.click("#zoom-in");
  assert.ok((await viewBox())[2] < width);
  await page.click("#zoom-all");
  assert.equal((await viewBox())[2], width);
  await page.locator("[data-zone-row] button").first().click();
  const [x, y, w, h] = await viewBox();
  assert.ok(Math.abs(x + w / 2 - numbers.resurvey[0].x) < 0.02 && Math.abs(y + h / 2 + numbers.resurvey[0].y) < 0.02);
  await page.locator("#map").hover();
  assert.match(await page.locator("#readout").textContent(), /^x -?\d+\.\d{3} m, y -?\d+\.\d{3} m: not surveyed$/);
  await page.locator("#map").press("0");
  await page.mouse.move(0, 0);
  await page.locator("#map").hover({ position: { x: 200, y: 200 } });
  assert.match(await page.locator("#readout").textContent(), /seen by \d+ frames?, \d+ usable keypoints in view$/);
});

test("fits on a phone", async () => {
  await page.setViewportSize({ width: 390, height: 844 });
  const width = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(width <= 390, `the page is ${width} px wide`);
  await takeScreenshot("report-phone");
});

test("can be printed", async () => {
  await page.emulateMedia({ media: "print" });
  assert.equal(await page.locator("#layers").isVisible(), false);
  assert.equal(await page.locator("#map").isVisible(), true);
  assert.ok((await page.pdf({ format: "A4" })).length > 50_000);
});
