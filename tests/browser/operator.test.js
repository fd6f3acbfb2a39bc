// SPDX-License-Identifier: Apache-2.0
// What an operator of many vehicles does with the page: all states at a glance, alerts, search, maps and their versions.
import assert from "node:assert/strict";
import { chmodSync, copyFileSync, writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { join } from "node:path";

import { drawnVehicle, takeScreenshot, usePages } from "./browser.js";
import { buildMap, makeMaps, registerVehicle, sampleImage, sendFrame, startServer } from "./product.js";
import { Stub, makeFix, makeVehicle } from "./stub.js";

const TOKEN = "a-token-of-the-browser-test";

const context = usePages();
let maps;
let server;
let stub;

before(async () => {
  maps = makeMaps();
  copyFileSync(join(maps.maps, "sample.floormap"), join(maps.maps, "annex.floormap"));
  writeFileSync(join(maps.maps, "broken.floormap"), "no map");
  server = await startServer(maps.maps);
  stub = await new Stub(server.url, OVERRIDES).start();
});

after(async () => {
  await stub?.stop();
  assert.equal(await server?.stop(), 0, "the server stops with exit code 0");
  maps?.remove();
});

const odometry = {
  health: "rejected", reason: "reversed", cure: "Change the sign of dx and dy.", scale: 1, yaw_scale: 1, time_offset_s: 0,
};

function makeShift() {
  return [
    makeVehicle("agv-1", { x: 0.6, y: 0.4, yaw: 0.5 }),
    makeVehicle("agv-2", { x: 1.2, y: 0.9, yaw: 2 }, { status: "tracking_odometry" }),
    makeVehicle("agv-3", { x: 1.6, y: 0.5, sigma: 0.15 }, { status: "lost" }),
    makeVehicle("agv-4", { x: 0.3, y: 1.2 }, { status: "stale", silent_s: 400 }),
    makeVehicle("agv-5", { x: 1.9, y: 1.3, yaw: -1 }, { odometry }),
    makeVehicle("agv-6", { x: 1, y: 1.4 }, { camera_status: "implausible" }),
    makeVehicle("cart-1", { x: 1, y: 1.4 }, { map: "annex" }),
    makeVehicle("cart-2", { x: 0, y: 0 }, { status: "lost", pose: null }),
  ];
}

/// What the server says of agv-2 when asked for it alone.
const details = {
  since_fix: { seconds: 0.8, metres: 0.31, radians: 0.2 },
  fixes: { accepted: 411, reanchored: 1, rejected: { jump_distance: 3, wrong_fix_risk: 1 } },
  camera_estimate: { status: "corrected", off_px: 1.4, fixes: 240 },
};
const findings = [
  { about: "floor", status: "ok", sentence: "99 of 100 images were found in the map", cure: "" },
  { about: "odometry", status: "note", sentence: "turns are measured 1.5 % too short", cure: "Compensated; calibrate its wheels." },
];
const OVERRIDES = {
  "/v1/vehicles/agv-2": () => details,
  "/v1/vehicles/agv-2/diagnosis": () => ({ vehicle: "agv-2", status: "note", findings }),
};

/// agv-2 drives a curve with an image every few centimetres, one of which is rejected.
function driveCurve() {
  const vehicle = stub.vehicles[1];
  const { pose } = vehicle;
  for (let i = 0; i <= 24; i += 1) {
    const angle = 2 - 0.06 * i;
    const [x, y] = [1.2 + 0.45 * (Math.cos(angle) - Math.cos(2)), 0.9 + 0.45 * (Math.sin(angle) - Math.sin(2))];
    const at = { ...pose, stamp: pose.stamp + 0.1 * i, x, y, yaw: angle - Math.PI / 2 };
    const fix = {
      keypoints: 480, matches: 210, inliers: Math.round(170 + 40 * Math.sin(i)), rms_m: 0.0004 + 0.0001 * Math.cos(2 * i),
      p_wrong: 10 ** (-8 + 2 * Math.sin(1.7 * i)), search: "prior",
    };
    const rejected = { accepted: false, reject_reason: "jump_distance", pose: { ...at, x: x + 0.5 }, fix };
    stub.emitPose({ ...vehicle, pose: at });
    stub.emit(makeFix(vehicle, i === 22 ? rejected : { pose: at, fix }));
  }
}

async function open(query = "?map=sample") {
  stub.vehicles = makeShift();
  await context.page.goto(`${stub.url}/${query}`);
  await context.page.locator("#vehicles li").first().waitFor();
  return context.page;
}

const texts = (locator) => locator.evaluateAll((elements) => elements.map((element) => element.textContent));

test("all maps and vehicles are seen at a glance", async () => {
  const page = await open("");
  assert.deepEqual(await texts(page.locator("#state-counts li:not([hidden]) button")),
    ["✕2 lost", "?0 ambiguous", "○1 silent", "◐1 on odometry", "●4 localized"]);
  assert.deepEqual(await texts(page.locator("#maps .name")), ["annex", "sample", "broken"], "maps with vehicles come first");
  assert.deepEqual(await texts(page.locator('#maps li[data-key="sample"] .chip')), ["✕ 2", "○ 1", "◐ 1", "● 3"]);
  await page.locator('#maps li[data-key="sample"] button').click();
  assert.equal(new URL(page.url()).searchParams.get("map"), "sample");
  await page.reload();
  await page.locator('#maps li[data-key="sample"] button[aria-current="true"]').waitFor();
  await takeScreenshot(page, "glance");
});

test("alerts are sorted by severity, and say since when", async () => {
  const page = await open();
  const rows = await texts(page.locator("#alerts li"));
  const heads = rows.map((text) => text.replace(/since.*/, ""));
  assert.deepEqual(heads.slice(0, 3).sort(), ["▧brokenmap damaged", "↯agv-5odometry rejected", "✕agv-3lost"].sort());
  assert.deepEqual(heads.slice(3).sort(), ["○agv-4silent", "◎agv-6calibration off", "✕cart-2never found yet"].sort());
  assert.match(rows.find((text) => text.includes("agv-4")), /since \d\d:\d\d:\d\d \(7 min\)/);
  assert.match(rows.find((text) => text.includes("agv-5")), /Change the sign of dx and dy\./);
  stub.emit(["status", { vehicle: "agv-1", map: "sample", status: "lost", before: "localized", silent_s: 0 }]);
  const lost = page.locator("#alerts li").filter({ hasText: "agv-1" });
  await lost.waitFor();
  assert.match(await lost.textContent(), /agv-1lostsince \d\d:\d\d:\d\d/);
  await lost.getByRole("button").click();
  await page.locator("#panel h2").getByText("agv-1").waitFor();
});

test("vehicles are found by name, state and order", async () => {
  const page = await open();
  const names = page.locator("#vehicles li .name");
  assert.deepEqual((await texts(names)).slice(0, 2).sort(), ["agv-3", "cart-2"], "the most urgent come first");
  await page.keyboard.press("/");
  await page.keyboard.type("CART");
  await page.waitForFunction(() => document.querySelectorAll("#vehicles li").length === 2);
  assert.deepEqual((await texts(names)).sort(), ["cart-1", "cart-2"], "on all maps");
  await page.fill("#search", "zz");
  await page.getByText('No vehicle has "zz" in its name.').waitFor();
  await page.fill("#search", "");
  await page.selectOption("#order", "name");
  assert.deepEqual(await texts(names), ["agv-1", "agv-2", "agv-3", "agv-4", "agv-5", "agv-6", "cart-2"]);
  await page.getByRole("button", { name: /silent/ }).first().click();
  assert.deepEqual(await texts(names), ["agv-4"]);
  assert.match(page.url(), /state=stale&order=name/);
});

test("a silent vehicle stays as a ghost where it was last", async () => {
  const page = await open();
  await drawnVehicle(page, "agv-4", "stale");
  assert.match(await page.locator("#vehicles li").filter({ hasText: "agv-4" }).textContent(), /silent.*7 min ago/);
});

test("an ambiguous vehicle shows where it may be", async () => {
  const page = await open();
  const places = [{ x: 0.4, y: 0.4, yaw: 0, weight: 0.7, inliers: 40 }, { x: 1.4, y: 0.4, yaw: 1, weight: 0.3, inliers: 20 }];
  stub.emit(makeFix(stub.vehicles[2], { status: "ambiguous", pose: undefined, accepted: undefined, alternatives: places }));
  await drawnVehicle(page, "agv-3", "ambiguous");
  const alternatives = await page.evaluate(() =>
    globalThis.floorlocPage.fleet.vehicles.get("agv-3").alternatives().map(({ weight }) => weight));
  assert.deepEqual(alternatives, [0.7, 0.3]);
  await page.locator("#alerts li").filter({ hasText: "may be at several places" }).getByRole("button").click();
  await page.getByText("2 places look like it").waitFor();
  await takeScreenshot(page, "ambiguous");
  stub.emit(makeFix(stub.vehicles[2]), ["status", { vehicle: "agv-3", map: "sample", status: "localized", before: "lost", silent_s: 0 }]);
  await drawnVehicle(page, "agv-3", "localized");
});

test("the first images of a vehicle are its own, though they come before the list that has it", async () => {
  const page = await open();
  const newcomer = makeVehicle("newcomer", { x: 1, y: 0.8 });
  const first = [0, 1, 2].map(() => makeFix(newcomer));
  stub.vehicles.push({ ...newcomer, last_fix: first[2][1] });
  stub.emit(["vehicle", { vehicle: "newcomer", map: "sample", change: "registered" }], ...first);
  await page.locator("#vehicles li").filter({ hasText: "newcomer" }).getByRole("button").click();
  await page.locator("#panel-fixes li").nth(2).waitFor();
});

test("a vehicle is followed, until the floor is moved by hand", async () => {
  const page = await open("?map=sample&vehicle=agv-1");
  await page.getByRole("button", { name: "Follow" }).click();
  const centred = () => page.waitForFunction(() => {
    const { floor, fleet } = globalThis.floorlocPage;
    const { drawn } = floor.fleet;
    const entry = drawn.find(({ vehicle }) => vehicle === fleet.vehicles.get("agv-1"));
    return Math.abs(entry.x - floor.element.clientWidth / 2) < 3 && Math.abs(entry.y - floor.element.clientHeight / 2) < 3;
  });
  await centred();
  const [vehicle] = stub.vehicles;
  stub.emitPose({ ...vehicle, epoch: 1, pose: { ...vehicle.pose, x: 1.5, y: 1, stamp: Date.now() / 1000 } });
  await page.waitForFunction(() => Math.abs(globalThis.floorlocPage.floor.leaflet.getCenter().lng - 1.5) < 0.01);
  await centred();
  const floor = await page.locator("#floor").boundingBox();
  await page.mouse.move(floor.x + 200, floor.y + 200);
  await page.mouse.down();
  await page.mouse.move(floor.x + 260, floor.y + 240, { steps: 4 });
  await page.mouse.up();
  assert.equal(await page.getByRole("button", { name: "Follow" }).getAttribute("aria-pressed"), "false");
});

test("the keyboard reaches everything", async () => {
  const page = await open();
  await page.locator("#vehicles li button").first().focus();
  await page.keyboard.press("Enter");
  await page.locator("#panel").waitFor();
  await page.waitForTimeout(1200); // two updates of the lists
  assert.equal(await page.evaluate(() => document.activeElement.closest("#vehicles") !== null), true, "updates leave the focus");
  await page.keyboard.press("Escape");
  await page.locator("#panel").waitFor({ state: "hidden" });
  const nameless = await page.evaluate(() => [...document.querySelectorAll("button, a, input, select, summary")]
    .filter((element) => element.checkVisibility() && !(element.textContent.trim() || element.ariaLabel || element.labels?.length))
    .map((element) => element.outerHTML));
  assert.deepEqual(nameless, []);
});

test("a damaged map says so, and an empty server what to do", async () => {
  const { page } = context;
  await page.goto(`${stub.url}/?map=broken`);
  await page.getByText(/The map 'broken' cannot be shown: /).waitFor();
  await page.locator("#alerts").getByText("map damaged").waitFor();
  stub.vehicles = [];
  stub.overrides = { "/v1/maps": () => ({ maps: [] }) };
  try {
    await page.goto(stub.url);
    await page.locator("#no-map").getByText(/floorloc-mapbuilder build --survey/).waitFor();
    await page.locator("#vehicles").getByText(/curl -X PUT/).waitFor();
    await takeScreenshot(page, "empty");
  } finally {
    stub.overrides = OVERRIDES;
  }
});

for (const [name, width, height] of [["phone", 320, 640], ["desktop", 1280, 800], ["wall", 3840, 2160]]) {
  for (const colorScheme of ["light", "dark"]) {
    test(`fits on a ${name}, ${colorScheme}`, async () => {
      const { page } = context;
      await page.emulateMedia({ colorScheme });
      await page.setViewportSize({ width, height });
      await open("?map=sample&vehicle=agv-2");
      driveCurve();
      await page.locator("img.leaflet-tile-loaded").first().waitFor();
      await page.locator("#panel-fixes li").nth(24).waitFor();
      await page.getByText("411 accepted, 4 rejected").waitFor();
      await page.getByText("Compensated; calibrate its wheels.").waitFor();
      assert.match(await page.locator("#panel-fixes .bad").textContent(), /rejected: too far from the expected place/);
      const over = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(over <= width, `the page is ${over} px wide`);
      const dark = await page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number)[0] < 60);
      assert.equal(dark, colorScheme === "dark");
      await takeScreenshot(page, `${name}-${colorScheme}`);
    });
  }
}

test("a map's versions are listed, uploaded, activated and rolled back", async () => {
  const { page } = context;
  const folder = makeMaps(join(maps.maps, "sample.floormap"));
  const keeper = await startServer(folder.maps, "127.0.0.1:0", {});
  try {
    await registerVehicle(keeper.url, "agv-1");
    await page.goto(keeper.url);
    await page.locator("#versions summary").click();
    await page.locator("#version-list li").getByText("● served").waitFor();
    assert.equal(await page.locator("#roll-back").isDisabled(), true);
    await page.setInputFiles("#upload-file", join(maps.maps, "broken.floormap"));
    await page.getByRole("button", { name: "Upload", exact: true }).click();
    await page.locator("#versions-said.failed").waitFor();
    await page.setInputFiles("#upload-file", join(folder.maps, "sample.floormap"));
    await page.fill("#upload-name", "copy");
    await page.getByRole("button", { name: "Upload", exact: true }).click();
    await page.getByText(/of copy is served\./).waitFor();
    await page.locator('#maps li[data-key="copy"]').waitFor();

    await sendFrame(keeper.url, "agv-1", sampleImage(5), 100);
    await page.setInputFiles("#upload-file", buildMap(join(folder.maps, ".."), "other.floormap", 14));
    await page.fill("#upload-name", "sample");
    await page.getByRole("button", { name: "Upload", exact: true }).click();
    await page.getByText(/is kept, and waits for its activation\./).waitFor();
    await page.getByText(/another frame: vehicles will be lost until their next image, \d\.\d m² less/).waitFor();
    await takeScreenshot(page, "versions");
    await page.getByRole("button", { name: /^Activate version/ }).click();
    await page.getByText(/0 vehicles keep their pose, 1 are lost/).waitFor();
    await page.getByRole("button", { name: /^Roll back to/ }).click();
    await page.waitForFunction(() => document.querySelectorAll("#version-list li")[1].textContent.includes("● served"));
    await page.getByRole("button", { name: /^Delete version/ }).click();
    await page.getByText(/Version [0-9a-f]{8} is deleted\./).waitFor();
    await page.waitForFunction(() => document.querySelectorAll("#version-list li").length === 1);
  } finally {
    assert.equal(await keeper.stop(), 0);
    folder.remove();
  }
});

test("with protected reads the page asks for the token, and shows tiles with it", async () => {
  const { page } = context;
  const folder = makeMaps(join(maps.maps, "sample.floormap"));
  const token = join(folder.maps, "..", "token");
  writeFileSync(token, `${TOKEN}\n`);
  chmodSync(token, 0o600);
  const guarded = await startServer(folder.maps, "127.0.0.1:0", { token_file: token, protect_reads: true, read_only: true });
  try {
    await page.goto(guarded.url);
    await page.getByRole("dialog").getByText(/wants a token/).waitFor();
    await page.getByRole("textbox", { name: "Token" }).fill(TOKEN);
    await page.getByRole("button", { name: "Use it" }).click();
    await page.getByText("connected", { exact: true }).waitFor();
    await page.waitForFunction(() =>
      [...document.querySelectorAll("img.leaflet-tile-loaded")].some((tile) => tile.naturalWidth === 256));
  } finally {
    assert.equal(await guarded.stop(), 0);
    folder.remove();
  }
});

test("a change asks for the token, once", async () => {
  const page = await open("?map=sample&vehicle=agv-1");
  const wanted = page.getByRole("dialog").getByText("wants a token for that");
  await page.route("**/initialpose", (route) => (route.request().headers().authorization === `Bearer ${TOKEN}`
    ? route.fulfill({ json: {} })
    : route.fulfill({ status: 401, json: { code: "unauthorized", detail: "A token is needed." } })));
  await page.getByRole("button", { name: "Set its pose" }).click();
  const set = page.getByRole("button", { name: "Set this pose" });
  await set.click();
  await wanted.waitFor();
  await page.getByRole("button", { name: "Cancel" }).last().click();
  await set.click();
  await page.locator("#pose-error").getByText("A token is needed.").waitFor();
  assert.equal(await wanted.isVisible(), false);
  await page.locator("#token-open").click();
  await page.getByRole("textbox", { name: "Token" }).fill(TOKEN);
  await page.getByRole("button", { name: "Use it" }).click();
  await set.click();
  await page.locator("#pose-verdict.waiting").waitFor();
});
