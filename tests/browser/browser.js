// SPDX-License-Identifier: Apache-2.0
// A Chromium for a file of tests, and a new page for each test whose errors fail it. FLOORLOC_SCREENSHOTS: folder for
// screenshots; FLOORLOC_WEB: folder whose files are used instead of those in the server, without a build.
import assert from "node:assert/strict";
import { existsSync, mkdirSync } from "node:fs";
import { after, afterEach, before, beforeEach } from "node:test";
import { join } from "node:path";
import { chromium } from "playwright-core";

const ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
  "--disable-background-networking", "--disable-component-update", "--disable-sync"];

export const launch = () => chromium.launch({ executablePath: "/usr/bin/chromium", args: ARGUMENTS });

/// Serves the page's files from FLOORLOC_WEB, with the headers of the server.
async function useFolder(page) {
  const folder = process.env.FLOORLOC_WEB;
  const answer = async (route, path) => {
    if (!existsSync(path)) {
      return route.continue();
    }
    const { ok, headers } = await fetch(new URL("/", route.request().url()).href).then(
      ({ ok, headers }) => ({ ok, headers: Object.fromEntries(headers) }), () => ({ ok: false }));
    if (!ok) {
      return route.abort();
    }
    return route.fulfill({ path, headers: { "content-security-policy": headers["content-security-policy"] } });
  };
  await page.route((url) => url.pathname === "/", (route) => answer(route, join(folder, "index.html")));
  await page.route("**/web/**", (route) => answer(route, join(folder, new URL(route.request().url()).pathname.slice(5))));
}

/// Registers hooks; the returned object has the browser and the page of the test that runs.
export function usePages(options = {}) {
  const context = { browser: null, page: null, errors: [] };
  before(async () => {
    context.browser = await launch();
  });
  after(() => context.browser?.close());
  beforeEach(async () => {
    context.page = await context.browser.newPage({ viewport: { width: 1280, height: 800 }, ...options });
    context.errors = [];
    context.page.on("pageerror", (error) => context.errors.push(error.message));
    context.page.on("console", (message) => {
      if (message.text().includes("Content Security Policy")) {
        context.errors.push(message.text());
      }
    });
    if (process.env.FLOORLOC_WEB) {
      await useFolder(context.page);
    }
  });
  afterEach(async () => {
    await context.page.close();
    assert.deepEqual(context.errors, []);
  });
  return context;
}

export async function takeScreenshot(page, name) {
  const folder = process.env.FLOORLOC_SCREENSHOTS;
  if (folder) {
    mkdirSync(folder, { recursive: true });
    await page.screenshot({ path: join(folder, `${name}.png`) });
  }
}

/// The same in both themes, on a desk and on a phone.
export async function takeScreenshots(page, name) {
  if (process.env.FLOORLOC_SCREENSHOTS) {
    const desk = page.viewportSize();
    for (const colorScheme of ["dark", "light"]) {
      await page.emulateMedia({ colorScheme });
      for (const [size, viewport] of [["phone", { width: 390, height: 800 }], ["desk", desk]]) {
        await page.setViewportSize(viewport);
        await page.waitForTimeout(700);
        await takeScreenshot(page, `${name}-${size}-${colorScheme}`);
      }
    }
  }
}

/// What the canvas of vehicles shows: [{id, state, x, y}] in pixels of the floor.
export const drawnVehicles = (page) => page.evaluate(() => {
  const { drawn, inView } = globalThis.floorlocPage.floor.fleet ?? { drawn: [], inView: 0 };
  return drawn.slice(0, inView).map(({ vehicle, x, y, yaw }) => ({ id: vehicle.id, state: vehicle.state, x, y, yaw }));
});

/// Waits until the canvas shows a vehicle in a state, where its last pose is, and returns where.
export async function drawnVehicle(page, id, state) {
  await page.waitForFunction(([id, state]) => {
    const { drawn, inView, project } = globalThis.floorlocPage?.floor.fleet ?? {};
    const entry = drawn?.slice(0, inView).find(({ vehicle }) => vehicle.id === id && (!state || vehicle.state === state));
    if (!entry) {
      return false;
    }
    const { k, ox, oy } = project.call(globalThis.floorlocPage.floor.fleet);
    const { x, y } = entry.vehicle.pose;
    return Math.hypot(k * x + ox - entry.x, oy - k * y - entry.y) < 0.5;
  }, [id, state]);
  return (await drawnVehicles(page)).find((vehicle) => vehicle.id === id);
}
