// SPDX-License-Identifier: Apache-2.0
// Runs the real programs: builds a map from the sample survey and serves it.
import { execFileSync, spawn } from "node:child_process";
import { copyFileSync, cpSync, mkdirSync, mkdtempSync, readFileSync, renameSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const root = join(dirname(fileURLToPath(import.meta.url)), "..", "..");
const bin = process.env.FLOORLOC_BIN ?? join(root, "build", "release", "bin");
const SURVEY_FRAMES = 40;

export const sampleImage = (number) =>
  join(root, "maps", "sample", "survey", "images", `${String(number).padStart(6, "0")}.jpg`);

/// The first frames of the sample survey, so that the map is built in seconds; or the last ones of a drive (count < 0).
function shortSurvey(folder, count, name = "survey") {
  const sample = join(root, "maps", "sample", name);
  const survey = join(folder, `${name}-${count}`);
  mkdirSync(survey);
  for (const name of ["camera.yaml", "floor.yaml", "odometry.tum"]) {
    copyFileSync(join(sample, name), join(survey, name));
  }
  const [head, ...frames] = readFileSync(join(sample, "frames.csv"), "utf8").trim().split("\n");
  const kept = count < 0 ? frames.slice(count) : frames.slice(0, count);
  writeFileSync(join(survey, "frames.csv"), `${[head, ...kept].join("\n")}\n`);
  symlinkSync(join(sample, "images"), join(survey, "images"));
  return survey;
}

/// Builds folder/NAME from the first frames of the sample survey.
export function buildMap(folder, name, frames = SURVEY_FRAMES) {
  const map = join(folder, name);
  execFileSync(join(bin, "floorloc-mapbuilder"), ["build", "--survey", shortSurvey(folder, frames), "--out", map],
    { stdio: "ignore" });
  return map;
}

/// A temporary folder with maps/sample.floormap: a copy of an existing map (FLOORLOC_MAP), or one that is built.
export function makeMaps(existing = process.env.FLOORLOC_MAP) {
  const folder = mkdtempSync(join(tmpdir(), "floorloc-browser-"));
  const maps = join(folder, "maps");
  mkdirSync(maps);
  const map = join(maps, "sample.floormap");
  if (existing) {
    cpSync(existing, map);
  } else {
    renameSync(buildMap(folder, "sample.floormap"), map);
  }
  return { maps, remove: () => rmSync(folder, { recursive: true, force: true }) };
}

/// Localizes the end of the sample drive in a map; returns the file of its results, fused.jsonl beside the maps folder.
export function fuseDrive(map) {
  const folder = join(dirname(map), "..");
  const out = join(folder, "fused");
  execFileSync(join(bin, "floorloc-mapbuilder"), ["localize", "--map", map, "--frames", shortSurvey(folder, -10, "drive"),
    "--out", `${out}.tum`, "--results", `${out}.jsonl`, "--fuse"], { stdio: "ignore" });
  return `${out}.jsonl`;
}

/// x, y and yaw of a row of a TUM file.
function planarPose(row) {
  const [, x, y, , , , qz, qw] = row.split(" ").map(Number);
  return { x, y, yaw: 2 * Math.atan2(qz, qw) };
}

/// The report of a map whose survey has a hole and a missing image: {folder, hole: its centre in metres, remove}.
export function makeReport() {
  const all = mkdtempSync(join(tmpdir(), "floorloc-report-"));
  const survey = join(all, "survey");
  cpSync(join(root, "maps", "sample", "survey"), survey, { recursive: true });
  const rows = (name) => readFileSync(join(survey, name), "utf8").trim().split("\n");
  const poses = rows("groundtruth.tum").map(planarPose);
  const view = (pose) => ({ x: pose.x + 0.2 * Math.cos(pose.yaw), y: pose.y + 0.2 * Math.sin(pose.yaw) });
  const middle = { x: 1.25, y: 0.9 };
  const inHole = (pose) => Math.hypot(view(pose).x - middle.x, view(pose).y - middle.y) < 0.42;
  const [head, ...frames] = rows("frames.csv");
  const kept = frames.filter((_, i) => !inHole(poses[i]));
  writeFileSync(join(survey, "frames.csv"), `${[head, ...kept, "1800000000.0,images/missing.jpg"].join("\n")}\n`);
  const folder = join(all, "report");
  execFileSync(join(bin, "floorloc-mapbuilder"), ["build", "--survey", survey, "--out", join(all, "hall.floormap"),
    "--report", folder], { stdio: "ignore" });
  // The map's frame is that of odometry, whose origin differs from the ground truth's.
  const start = planarPose(rows("odometry.tum")[0]);
  const turn = start.yaw - poses[0].yaw;
  const [dx, dy] = [middle.x - poses[0].x, middle.y - poses[0].y];
  const hole = { x: start.x + Math.cos(turn) * dx - Math.sin(turn) * dy,
    y: start.y + Math.sin(turn) * dx + Math.cos(turn) * dy };
  return { folder, hole, remove: () => rmSync(all, { recursive: true, force: true }) };
}

/// Resolves with {url, stop} when the server prints its address. By default it keeps nothing, and the next test begins
/// without vehicles.
export function startServer(maps, listen = "127.0.0.1:0", configuration = { read_only: true }) {
  const config = join(mkdtempSync(join(tmpdir(), "server-")), "config.json");
  writeFileSync(config, JSON.stringify(configuration));
  const server = spawn(join(bin, "floorloc-server"), ["--maps", maps, "--listen", listen, "--config", config],
    { stdio: "pipe" });
  const ended = new Promise((resolve) => server.once("exit", resolve));
  ended.then(() => rmSync(dirname(config), { recursive: true, force: true }));
  const stop = () => {
    server.kill("SIGTERM");
    return ended;
  };
  return new Promise((resolve, reject) => {
    let log = "";
    server.stderr.on("data", (text) => {
      log += text;
      const url = log.match(/serving \d+ maps on (http:\/\/\S+)\//)?.[1];
      if (url) {
        resolve({ url, stop });
      }
    });
    ended.then((code) => reject(new Error(`floorloc-server ended with ${code}: ${log}`)));
  });
}

/// Registers a vehicle with the map's camera.
export async function registerVehicle(url, id) {
  const { camera, floor } = await (await fetch(`${url}/v1/maps/sample`)).json();
  const response = await fetch(`${url}/v1/vehicles/${id}`, {
    method: "PUT",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ map: "sample", camera, floor }),
  });
  return response.status;
}

export async function localize(url, id, image) {
  const response = await fetch(`${url}/v1/maps/sample/localize?vehicle=${id}`, {
    method: "POST",
    headers: { "Content-Type": "image/jpeg", "X-Deadline-Ms": "30000" },
    body: readFileSync(image),
  });
  return response.json();
}

/// Sends an image of a vehicle with its stamp.
export async function sendFrame(url, id, image, stamp) {
  const response = await fetch(`${url}/v1/vehicles/${id}/frames?stamp=${stamp}`, {
    method: "POST",
    headers: { "Content-Type": "image/jpeg", "X-Deadline-Ms": "30000" },
    body: readFileSync(image),
  });
  return response.json();
}

export async function sendOdometry(url, id, increment) {
  const response = await fetch(`${url}/v1/vehicles/${id}/odometry`, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(increment),
  });
  return response.json();
}
