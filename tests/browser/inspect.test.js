// SPDX-License-Identifier: Apache-2.0
// What an operator looks into: an image over the floor, where images are found, a drive that was recorded.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { join } from "node:path";

import { drawnVehicle, takeScreenshots, usePages } from "./browser.js";
import { fuseDrive, makeMaps, registerVehicle, sampleImage, sendFrame, startServer } from "./product.js";

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

/// How the image that is laid over the floor correlates with the mosaic beneath, -1 to 1: the canvas against the tiles, by
/// what differs from the surroundings, as light and vignetting do not.
const agreement = (page) => page.evaluate(() => {
  const { floor } = globalThis.floorlocPage;
  const canvas = floor.fleet.canvas;
  const { width, height } = canvas;
  const scale = width / floor.element.clientWidth;
  const frame = floor.element.getBoundingClientRect();
  const below = new OffscreenCanvas(width, height).getContext("2d");
  for (const tile of floor.element.querySelectorAll("img.leaflet-tile-loaded")) {
    const { x, y, width: w, height: h } = tile.getBoundingClientRect();
    below.drawImage(tile, scale * (x - frame.x), scale * (y - frame.y), scale * w, scale * h);
  }
  const [over, under] = [canvas.getContext("2d"), below].map((context) => context.getImageData(0, 0, width, height).data);
  const detail = (data, i) => data[i] - [16, -16, 16 * width, -16 * width].reduce((sum, step) => sum + data[i + step] / 4, 0);
  let [n, a, b, aa, bb, ab] = [0, 0, 0, 0, 0, 0];
  for (let i = 0; i < over.length; i += 4) {
    if (over[i + 3] === 255 && under[i + 3] === 255) {
      const [p, q] = [detail(over, i), detail(under, i)];
      n += 1;
      a += p;
      b += q;
      aa += p * p;
      bb += q * q;
      ab += p * q;
    }
  }
  return (n * ab - a * b) / Math.sqrt((n * aa - a * a) * (n * bb - b * b));
});

test("the last image of a vehicle lies on the floor where it was found, and at rivals", async () => {
  const { page } = context;
  await registerVehicle(server.url, "looked");
  const { fix } = await sendFrame(server.url, "looked", sampleImage(5), 100);
  await page.goto(`${server.url}/?map=sample&vehicle=looked`);
  await page.getByRole("button", { name: "Look into its last image" }).click();
  const [found, rival] = [0, 1].map((i) => page.getByRole("radio").nth(i));
  await rival.waitFor();
  assert.match(await page.locator("#inspector-poses label").first().textContent(),
    new RegExp(`^the pose that was found: ${fix.inliers} of \\d+ matches agree, poses like that by chance: none$`));
  await page.waitForTimeout(300); // tiles of the new view fade in
  await takeScreenshots(page, "inspector");
  await page.getByRole("checkbox", { name: "Matches" }).uncheck();
  await page.locator("#inspector-blend").fill("100");
  await page.getByRole("button", { name: "Trail" }).click();
  await page.waitForFunction(() => ![...document.querySelectorAll(".leaflet-tile")].some((tile) => !tile.classList.contains("leaflet-tile-loaded")));
  const right = await agreement(page);
  assert.ok(right > 0.3, `correlation with the mosaic: ${right}`);
  await found.focus();
  await page.keyboard.press("ArrowDown");
  assert.equal(await rival.isChecked(), true);
  await page.waitForTimeout(500);
  const wrong = await agreement(page);
  assert.ok(wrong < right - 0.1, `at the rival: ${wrong}, before ${right}`);
  await sendFrame(server.url, "looked", sampleImage(6), 101);
  await page.getByRole("button", { name: "Show the newest image" }).click();
  await page.getByRole("button", { name: "Show the newest image" }).waitFor({ state: "hidden" });
  await page.keyboard.press("Escape");
  assert.equal(await page.locator("#inspector").isHidden(), true);
  assert.equal(await page.locator("#panel").isVisible(), true);
});

/// Opens a file of results, and stops it.
async function replay(page, file) {
  await page.locator("#replay-part").evaluate((part) => { part.open = true; });
  await page.setInputFiles("#replay-file", file);
  await page.waitForFunction(() => globalThis.floorlocPage.replay.drive);
  await page.evaluate(() => globalThis.floorlocPage.replay.play(false));
}

const seek = (page, seconds) => page.getByLabel("Time of the drive").fill(String(Number(seconds.toFixed(1))));

test("a recorded drive is replayed, at any time and speed", async () => {
  const { page } = context;
  const file = fuseDrive(join(maps.maps, "sample.floormap"));
  const lines = readFileSync(file, "utf8").trim().split("\n").map((line) => JSON.parse(line));
  await page.goto(`${server.url}/?map=sample`);
  await page.locator("img.leaflet-tile-loaded").first().waitFor();
  await replay(page, file);
  const last = lines.findLastIndex(({ fused }) => fused?.state === "localized");
  await seek(page, lines[last].timestamp - lines[0].timestamp + 0.04); // sliders have steps
  const drawn = await drawnVehicle(page, "fused.jsonl");
  assert.equal(drawn.state, "localized");
  await page.locator("#panel-state").getByText("● localized").waitFor();
  await page.waitForFunction((count) => document.querySelectorAll("#panel-fixes li").length === count, last + 1);
  await page.getByText(`${lines.slice(0, last + 1).filter(({ accepted }) => accepted).length} accepted, `).waitFor();
  assert.equal(await page.getByRole("button", { name: "Set its pose" }).isVisible(), false, "of a live vehicle only");
  await takeScreenshots(page, "replay");
  await seek(page, 0);
  await page.selectOption("#replay-speed", "16");
  await page.getByRole("button", { name: "Play" }).click();
  await page.waitForFunction(() => {
    const { drive, playing } = globalThis.floorlocPage.replay;
    return !playing && drive.time === drive.end;
  });
  assert.equal(await page.locator("#replay-time").evaluate(({ value, max }) => Number(max) - Number(value) < 0.1), true);
  await page.getByRole("button", { name: "End", exact: true }).click();
  assert.equal(await page.locator("#panel").isVisible(), false);
  assert.equal(await page.evaluate(() => globalThis.floorlocPage.vehiclesOnMap().some(({ recorded }) => recorded)), false);
});

test("files that are no drive are refused with a sentence that says why", async () => {
  const { page } = context;
  await page.goto(`${server.url}/?map=sample`);
  await page.locator("#replay-part summary").click();
  const line = {
    timestamp: 1, status: "localized", x: 100, y: 100, yaw: 0, covariance: [1, 0, 0, 0, 1, 0, 0, 0, 1], alternatives: [],
    fused: { x: 100, y: 100, yaw: 0, covariance: [1, 0, 0, 0, 1, 0, 0, 0, 1], state: "localized" },
  };
  const cases = [
    ["", /^The file is empty\. Choose the file that 'floorloc-mapbuilder localize --fuse --results FILE' wrote\.$/],
    ["\u0000\u0001 JFIF", /^Line 1 is no JSON\. /],
    ["1800000000.000000000 0.5 0.4 0 0 0 0.1 0.99\n", /^Line 1 is one of a trajectory, as --out writes it\. /],
    ['{"a": 1}', /^Line 1 has no timestamp and status\. /],
    [JSON.stringify({ ...line, fused: undefined }), /^Line 1 has no fused pose: the drive was localized without --fuse\. /],
    [JSON.stringify({ ...line, x: null }), /^Line 1 has a pose without numbers or state\. /],
    [`${JSON.stringify(line)}\n\n${JSON.stringify({ ...line, timestamp: 0 })}`, /^Line 3 is earlier than the one before it\. /],
  ];
  for (const [text, sentence] of cases) {
    await page.setInputFiles("#replay-file", { name: "file.jsonl", mimeType: "text/plain", buffer: Buffer.from(text) });
    await page.locator("#replay-said").getByText(sentence).waitFor();
    assert.equal(await page.locator("#replay").isVisible(), false);
  }
  await page.setInputFiles("#replay-file", { name: "far.jsonl", mimeType: "text/plain", buffer: Buffer.from(JSON.stringify(line)) });
  await page.getByText("Most of far.jsonl is outside of sample: was it localized in another map?").waitFor();
});

test("squares of the floor say where images are found, and where to survey again", async () => {
  const { page } = context;
  await registerVehicle(server.url, "counted");
  await sendFrame(server.url, "counted", sampleImage(5), 100);
  await page.goto(`${server.url}/?map=sample`);
  await page.getByText("Where images are found").click();
  await page.getByText(/^Of the last \d+ images since .*, \d+ were found\./).waitFor();
  await page.getByText("Nowhere, by the images so far.").waitFor();
  assert.equal(new URL(page.url()).searchParams.get("layer"), "success");

  const { extent } = await (await fetch(`${server.url}/v1/maps/sample`)).json();
  const cells = [];
  for (let y = Math.floor(2 * extent.y_min) / 2; y < extent.y_max - 0.25; y += 0.5) {
    for (let x = Math.floor(2 * extent.x_min) / 2; x < extent.x_max - 0.25; x += 0.5) {
      cells.push({ x, y, found: 400 - 30 * cells.length, missed: 5, inliers: 150, survey_again: false });
    }
  }
  const [good, bad] = cells;
  Object.assign(cells[2], { found: 90, missed: 12 });
  Object.assign(cells[3], { found: 60, missed: 40 });
  Object.assign(bad, { found: 8, missed: 32, survey_again: true });
  await page.route("**/v1/maps/sample/success", (route) => route.fulfill({
    json: { map: "sample", map_version: "0", since: 1.8e9, cell_m: 0.5, unplaced: 3, cells: cells.filter(({ found }) => found > 0) },
  }));
  await page.reload();
  const place = page.locator("#success-places button");
  await place.waitFor();
  assert.equal(await place.textContent(), `✕${(bad.x + 0.25).toFixed(2)}, ${(bad.y + 0.25).toFixed(2)} m: 8 of 40 found (20 %)`);
  await page.getByText("3 more were missed, nobody knows where.").waitFor();
  const colourOf = (cell) => page.evaluate(({ x, y }) => {
    const { fleet } = globalThis.floorlocPage.floor;
    fleet.draw();
    const { k, ox, oy } = fleet.project();
    const scale = globalThis.devicePixelRatio;
    return [...fleet.context.getImageData(scale * (k * (x + 0.2) + ox), scale * (oy - k * (y + 0.1)), 1, 1).data];
  }, cell);
  const [red, green] = [await colourOf(bad), await colourOf(good)];
  assert.ok(red[0] > 2 * red[1], `red: ${red}`);
  assert.ok(green[1] > 2 * green[0], `green: ${green}`);
  await takeScreenshots(page, "success");
  await place.click();
  const centre = await page.evaluate(() => globalThis.floorlocPage.floor.leaflet.getCenter());
  assert.ok(Math.hypot(centre.lng - bad.x - 0.25, centre.lat - bad.y - 0.25) < 0.05);
  await page.getByText("Where images are found").click();
  assert.equal(await page.evaluate(() => globalThis.floorlocPage.success.scene()), null);
});
