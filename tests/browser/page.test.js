// SPDX-License-Identifier: Apache-2.0
// Tests the web page in a browser with a real map and real images. FLOORLOC_BIN: folder of the programs.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { drawnVehicle, takeScreenshot, usePages } from "./browser.js";
import {
  localize, makeMaps, registerVehicle, sampleImage, sendFrame, sendOdometry, startServer,
} from "./product.js";

const context = usePages();
let maps;
let server;

before(async () => {
  maps = makeMaps();
  server = await startServer(maps.maps);
});

after(async () => {
  assert.equal(await server?.stop(), 0, "the server stops with exit code 0");
  maps?.remove();
});

const row = (page, id) => page.locator("#vehicles li").filter({ hasText: id });

test("shows the mosaic in metres", async () => {
  const { page } = context;
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
  const { page } = context;
  await page.goto(server.url);
  const { extent } = await (await fetch(`${server.url}/v1/maps/sample`)).json();
  await page.locator("img.leaflet-tile-loaded").first().waitFor();
  await page.locator("#floor").hover();
  const [x, y] = (await page.locator("#position").textContent()).match(/-?\d+\.\d+/g).map(Number);
  const middle = { x: (extent.x_min + extent.x_max) / 2, y: (extent.y_min + extent.y_max) / 2 };
  const tolerance = 0.05 * (extent.x_max - extent.x_min);
  assert.ok(Math.abs(x - middle.x) < tolerance && Math.abs(y - middle.y) < tolerance, `${x}, ${y}`);
});

test("single fixes appear by themselves", async () => {
  const { page } = context;
  await page.goto(server.url);
  assert.equal(await registerVehicle(server.url, "agv-7"), 201);
  await row(page, "agv-7").waitFor();
  for (const number of [5, 12, 19]) {
    assert.equal((await localize(server.url, "agv-7", sampleImage(number))).status, "localized");
  }
  await page.waitForFunction(() => globalThis.floorlocPage.fleet.loose.get("sample")?.length === 3);
  await row(page, "agv-7").getByText(/single images only/).waitFor();
  await page.locator("#alerts li").filter({ hasText: "agv-7" }).waitFor({ state: "detached" }); // it is found by images
  await row(page, "agv-7").getByRole("button").click();
  await page.locator("#panel-fixes li").nth(2).waitFor();
  assert.match(await page.locator("#panel-fixes li").first().textContent(), /✓ -?\d+\.\d{3}, -?\d+\.\d{3} m, -?\d+\.\d°$/);
  await takeScreenshot(page, "fixes");
});

test("a vehicle is drawn where the server has it, by what that is worth", async () => {
  const { page } = context;
  await page.goto(server.url);
  await registerVehicle(server.url, "tracked");
  assert.equal((await sendFrame(server.url, "tracked", sampleImage(5), 100)).status, "localized");
  const before = await drawnVehicle(page, "tracked", "localized");
  const moved = await sendOdometry(server.url, "tracked", { stamp: 102, dx: 0.5, dy: 0.2, dyaw: 1 });
  assert.equal(moved.status, "tracking_odometry");
  const after = await drawnVehicle(page, "tracked", "tracking_odometry");
  const metre = await page.evaluate(() => globalThis.floorlocPage.floor.fleet.project().k);
  const [dx, dy] = [(after.x - before.x) / metre, (before.y - after.y) / metre];
  assert.ok(Math.abs(Math.hypot(dx, dy) - Math.hypot(0.5, 0.2)) < 0.02, `it moved by ${dx}, ${dy} m`);
  assert.ok(Math.abs(after.yaw - before.yaw - 1) < 0.02, "and turned");
  await page.mouse.move(...await page.locator("#floor").boundingBox().then(({ x, y }) => [x + after.x, y + after.y]));
  await page.locator(".tooltip").getByText("tracked: on odometry").waitFor();
  assert.match(await row(page, "tracked").textContent(), /tracked.*on odometry/);
});

test("a click on a vehicle opens what is known of it", async () => {
  const { page } = context;
  await page.goto(server.url);
  await registerVehicle(server.url, "clicked");
  for (const [i, number] of [5, 6, 7, 8].entries()) {
    await sendFrame(server.url, "clicked", sampleImage(number), 100 + i);
  }
  const drawn = await drawnVehicle(page, "clicked");
  const floor = await page.locator("#floor").boundingBox();
  await page.mouse.click(floor.x + drawn.x, floor.y + drawn.y);
  await page.locator("#panel h2").getByText("clicked").waitFor();
  assert.match(page.url(), /vehicle=clicked/);
  await page.locator("#panel-facts").getByText(/^4 accepted, 0 rejected$/).waitFor();
  await page.locator("#panel-findings li").first().waitFor();
  assert.match(await page.locator("#panel-findings").textContent(), /floor: .*images were found/);
  await page.getByRole("img", { name: /Agreeing points of the last 4 images/ }).waitFor();
  await takeScreenshot(page, "vehicle");
});

test("a rejected fix says why", async () => {
  const { page } = context;
  await page.goto(server.url);
  await registerVehicle(server.url, "kidnapped");
  await sendFrame(server.url, "kidnapped", sampleImage(5), 100);
  const answer = await sendFrame(server.url, "kidnapped", sampleImage(30), 100.2);
  assert.equal(answer.fix.accepted, false);
  await row(page, "kidnapped").getByRole("button").click();
  const last = page.locator("#panel-fixes li.bad").first();
  await last.waitFor();
  assert.match(await last.textContent(), /rejected: (too far from the expected place|turned too far from the expected heading)/);
});

test("an image can be tried by hand", async () => {
  const { page } = context;
  await registerVehicle(server.url, "by-hand");
  await page.goto(server.url);
  await page.locator("#try-it summary").click();
  await page.setInputFiles("#image", sampleImage(8));
  await page.fill("#vehicle", "by-hand");
  await page.click("#localize");
  await page.getByText('"status": "localized"').waitFor();
  await page.locator("#inspector").getByText("000008.jpg").waitFor();
  await page.getByText(/the pose that was found: \d+ of \d+ matches agree/).waitFor();
  await page.fill("#vehicle", "nobody");
  await page.click("#localize");
  await page.getByText("(unknown_vehicle)").waitFor();
});

test("a pose set by hand is confirmed or contradicted by the next image", async () => {
  const { page } = context;
  await registerVehicle(server.url, "set");
  const { pose } = await sendFrame(server.url, "set", sampleImage(5), 100);
  await page.goto(`${server.url}/?map=sample&vehicle=set`);
  await page.getByRole("button", { name: "Set its pose" }).click();
  await page.getByLabel("x, m").fill(String(pose.x + 0.02));
  await page.getByLabel("y, m").fill(String(pose.y));
  await page.getByRole("button", { name: "Set this pose" }).click();
  await page.locator("#pose-verdict.waiting").waitFor();
  await sendFrame(server.url, "set", sampleImage(5), 101);
  await page.locator("#pose-verdict.confirmed").waitFor();
  assert.match(await page.locator("#pose-verdict").textContent(), /Confirmed by the next image, 2\d mm, 0\.\d° from/);

  // Drawn: pressed where the image isn't, and dragged upwards.
  await page.getByRole("button", { name: "Set its pose" }).click();
  const floor = await page.locator("#floor").boundingBox();
  const { k, ox, oy } = await page.evaluate(() => globalThis.floorlocPage.floor.fleet.project());
  const press = { x: floor.x + k * (pose.x + 1) + ox, y: floor.y + oy - k * (pose.y + 0.6) };
  await page.mouse.move(press.x, press.y);
  await page.mouse.down();
  await page.mouse.move(press.x, press.y - 60, { steps: 3 });
  await page.mouse.up();
  assert.ok(Math.abs(Number(await page.getByLabel("x, m").inputValue()) - pose.x - 1) < 0.02);
  assert.equal(await page.getByLabel("heading, °").inputValue(), "90.0");
  await page.getByRole("button", { name: "Set this pose" }).click();
  await page.locator("#pose-verdict.waiting").waitFor();
  await sendFrame(server.url, "set", sampleImage(5), 102);
  await page.locator("#pose-verdict.contradicted").waitFor();
  await takeScreenshot(page, "contradicted");
});

test("says when the server is away, and goes on where it was when it is back", async () => {
  const { page } = context;
  const other = await startServer(maps.maps);
  await page.goto(other.url);
  await page.getByText("connected", { exact: true }).waitFor();
  await page.evaluate(() => globalThis.floorlocPage.floor.leaflet.setZoom(3, { animate: false }));
  const view = () => page.evaluate(() => {
    const { leaflet } = globalThis.floorlocPage.floor;
    return [leaflet.getCenter().lng, leaflet.getCenter().lat, leaflet.getZoom()];
  });
  const before = await view();
  assert.equal(await other.stop(), 0);
  await page.getByText("not connected").waitFor();
  await page.getByText("The server does not answer").waitFor();
  const again = await startServer(maps.maps, other.url.replace("http://", ""));
  try {
    await page.getByText("connected", { exact: true }).waitFor();
    assert.equal(await page.locator("#message").isHidden(), true);
    (await view()).forEach((value, i) => assert.ok(Math.abs(value - before[i]) < 0.02, `${value}, before ${before[i]}`));
  } finally {
    await again.stop();
  }
});
