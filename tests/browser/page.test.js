// SPDX-License-Identifier: Apache-2.0
// Tests the web page in a browser with a real map. FLOORLOC_BIN: folder of the programs; FLOORLOC_SCREENSHOTS: folder
// for screenshots.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { after, before, beforeEach, afterEach, test } from "node:test";
import { join } from "node:path";
import { chromium } from "playwright-core";

import {
  localize, makeMaps, registerVehicle, sampleImage, sendFrame, sendOdometry, startServer,
} from "./product.js";

const ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
  "--disable-background-networking", "--disable-component-update", "--disable-sync"];

let maps;
let server;
let browser;
let page;
let page_errors;

before(async () => {
  maps = makeMaps();
  server = await startServer(maps.maps);
  browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ARGUMENTS });
});

after(async () => {
  await browser?.close();
  assert.equal(await server?.stop(), 0, "the server stops with exit code 0");
  maps?.remove();
});

beforeEach(async () => {
  page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  page_errors = [];
  page.on("pageerror", (error) => page_errors.push(error.message));
  page.on("console", (message) => {
    if (message.text().includes("Content Security Policy")) {
      page_errors.push(message.text());
    }
  });
});

afterEach(async () => {
  await page.close();
  assert.deepEqual(page_errors, []);
});

async function takeScreenshot(name) {
  const folder = process.env.FLOORLOC_SCREENSHOTS;
  if (folder) {
    mkdirSync(folder, { recursive: true });
    await page.screenshot({ path: join(folder, `${name}.png`) });
  }
}

test("shows the mosaic in metres", async () => {
  await page.goto(server.url);
  await page.locator("img.leaflet-tile-loaded").first().waitFor();
  const drawn = await page.locator("img.leaflet-tile-loaded").evaluateAll(
    (tiles) => tiles.filter((tile) => tile.naturalWidth === 256).length);
  assert.ok(drawn > 0, "tiles of the mosaic are drawn");
  assert.match(await page.locator(".leaflet-control-scale-line").textContent(), /^\d+ (m|cm|mm)$/);
  await page.locator("#floor").hover();
  assert.match(await page.locator("#position").textContent(), /^x -?\d+\.\d{3} m\s+y -?\d+\.\d{3} m$/);
});

test("the position under the mouse is that of the mosaic", async () => {
  await page.goto(server.url);
  const { extent } = await (await fetch(`${server.url}/v1/maps/sample`)).json();
  await page.locator("img.leaflet-tile-loaded").first().waitFor();
  await page.locator("#floor").hover();
  const [x, y] = (await page.locator("#position").textContent()).match(/-?\d+\.\d+/g).map(Number);
  const middle = { x: (extent.x_min + extent.x_max) / 2, y: (extent.y_min + extent.y_max) / 2 };
  const tolerance = 0.05 * (extent.x_max - extent.x_min);
  assert.ok(Math.abs(x - middle.x) < tolerance && Math.abs(y - middle.y) < tolerance, `${x}, ${y}`);
});

test("a fix appears by itself, where the robot is", async () => {
  await page.goto(server.url);
  assert.equal(await registerVehicle(server.url, "agv-7"), 201);
  await page.getByText("agv-7").first().waitFor();
  for (const number of [5, 12, 19]) {
    assert.equal((await localize(server.url, "agv-7", sampleImage(number))).status, "localized");
  }
  const arrows = page.locator("path.fix-arrow.localized");
  await arrows.nth(2).waitFor({ state: "attached" });
  assert.equal(await page.locator("path.fix-ellipse").count(), 3);
  const tile = await page.locator("#floor").boundingBox();
  const arrow = await arrows.nth(2).boundingBox();
  assert.ok(arrow.x > tile.x && arrow.x < tile.x + tile.width && arrow.y > tile.y && arrow.y < tile.y + tile.height);
  assert.match(await page.locator("#vehicles").textContent(), /agv-7\d+ s ago/);
  assert.equal(await page.locator("#fixes li").count(), 3);
  await takeScreenshot("fixes");
});

test("a vehicle is drawn where the server has it, coloured by what that is worth", async () => {
  await page.goto(server.url);
  await registerVehicle(server.url, "tracked");
  assert.equal((await sendFrame(server.url, "tracked", sampleImage(5), 100)).status, "localized");
  const arrow = page.locator("path.vehicle-arrow");
  await page.locator("path.vehicle-arrow.localized").waitFor({ state: "attached" });
  const before = await arrow.boundingBox();
  const moved = await sendOdometry(server.url, "tracked", { stamp: 102, dx: 0.5, dy: 0.2, dyaw: 1 });
  assert.equal(moved.status, "tracking_odometry");
  await page.locator("path.vehicle-arrow.tracking_odometry").waitFor({ state: "attached" });
  assert.equal(await arrow.count(), 1);
  const after = await arrow.boundingBox();
  assert.ok(Math.hypot(after.x - before.x, after.y - before.y) > 20, "it is drawn elsewhere");
  assert.match(await page.locator("#vehicles").textContent(), /trackedtracking odometry, \d+ s ago/);
  await takeScreenshot("vehicle");
});

test("odometry that images contradict is shown with its cure", async () => {
  await registerVehicle(server.url, "reversed");
  await registerVehicle(server.url, "doubtful");
  const health = {
    reversed: { health: "rejected", reason: "reversed", cure: "Change the sign of dx and dy." },
    doubtful: { health: "suspect", reason: "", cure: "" },
  };
  await page.route("**/v1/vehicles", async (route) => {
    const answer = await (await route.fetch()).json();
    for (const vehicle of answer.vehicles) {
      vehicle.odometry = health[vehicle.id] ?? vehicle.odometry;
    }
    await route.fulfill({ json: answer });
  });
  await page.goto(server.url);
  const item = (id) => page.locator("#vehicles li").filter({ hasText: id });
  await item("reversed").locator(".odometry-alert.rejected").waitFor();
  assert.match(await item("reversed").textContent(), /Odometry rejected\. Change the sign of dx and dy\./);
  assert.match(await item("doubtful").locator(".odometry-alert.suspect").textContent(), /^Odometry suspect/);
  assert.equal(await page.locator(".odometry-alert").count(), 2, "others have no alert");
  await takeScreenshot("odometry");
  const href = await item("reversed").getByRole("link", { name: "Diagnosis" }).getAttribute("href");
  const diagnosis = await (await fetch(server.url + href)).json();
  assert.equal(diagnosis.vehicle, "reversed");
});

test("an image can be tried by hand", async () => {
  await registerVehicle(server.url, "by-hand");
  await page.goto(server.url);
  await page.setInputFiles("#image", sampleImage(8));
  await page.fill("#vehicle", "by-hand");
  await page.click("#localize");
  await page.getByText('"status": "localized"').waitFor();
  await page.fill("#vehicle", "nobody");
  await page.click("#localize");
  await page.getByText("(unknown_vehicle)").waitFor();
});

test("fits on a phone", async () => {
  await page.setViewportSize({ width: 390, height: 844 });
  await page.goto(server.url);
  await page.locator("img.leaflet-tile-loaded").first().waitFor();
  const width = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(width <= 390, `the page is ${width} px wide`);
  await takeScreenshot("phone");
});

test("says when the server is away, and goes on when it is back", async () => {
  const other = await startServer(maps.maps);
  await page.goto(other.url);
  await page.getByText("connected", { exact: true }).waitFor();
  assert.equal(await other.stop(), 0);
  await page.getByText("The server does not answer").waitFor();
  const again = await startServer(maps.maps, other.url.replace("http://", ""));
  await page.getByText("connected", { exact: true }).waitFor();
  assert.equal(await page.locator("#message").isHidden(), true);
  assert.equal(await again.stop(), 0);
});
