// SPDX-License-Identifier: Apache-2.0
import * as api from "/web/api.js";
import { FloorView } from "/web/floor_view.js";

const POLL_MS = 1000;
const FIXES_LISTED = 40;

const $ = (id) => document.getElementById(id);

const state = { maps: [], map: null, since: 0, fixes: [], file: null };
const floor = new FloorView($("floor"), (x, y) => {
  $("position").textContent = x === null ? "–" : `x ${x.toFixed(3)} m   y ${y.toFixed(3)} m`;
});

function showMessage(text) {
  $("message").textContent = text ?? "";
  $("message").hidden = !text;
}

function showConnection(error) {
  $("connection").textContent = error ? "not connected" : "connected";
  $("connection").classList.toggle("away", Boolean(error));
}

function age(seconds) {
  if (seconds < 60) {
    return `${Math.max(0, seconds).toFixed(0)} s ago`;
  }
  return seconds < 3600 ? `${(seconds / 60).toFixed(0)} min ago` : `${(seconds / 3600).toFixed(0)} h ago`;
}

function listItem(left, right, className) {
  const item = document.createElement("li");
  for (const [text, name] of [[left, className], [right, ""]]) {
    const span = document.createElement("span");
    span.textContent = text;
    span.className = name;
    item.append(span);
  }
  return item;
}

function fillList(element, items, emptyText) {
  if (items.length === 0) {
    const item = document.createElement("li");
    item.className = "empty";
    item.textContent = emptyText;
    items = [item];
  }
  element.replaceChildren(...items);
}

/// A line below a vehicle whose odometry its images contradict, with the cure and a link to the diagnosis.
function odometryAlert(id, { health, cure }) {
  const alert = document.createElement("p");
  alert.className = `odometry-alert ${health}`;
  alert.append(health === "rejected" ? `Odometry rejected. ${cure} ` : "Odometry suspect: the last images contradict it. ");
  const link = document.createElement("a");
  link.href = `/v1/vehicles/${encodeURIComponent(id)}/diagnosis`;
  link.textContent = "Diagnosis";
  link.target = "_blank";
  alert.append(link);
  return alert;
}

function showVehicles(vehicles) {
  const now = Date.now() / 1000;
  const items = vehicles.map(({ id, pose, status, silent_s: silent, odometry, last_fix: fix }) => {
    const lastSeen = fix ? age(now - fix.received) : "no fix yet";
    const state = status === "stale" ? `silent for ${Math.round(silent)} s` : status.replaceAll("_", " ");
    const text = pose ? `${state}, ${lastSeen}` : lastSeen;
    const item = listItem(id, text, pose ? status : fix?.status ?? "");
    if (odometry?.health === "rejected" || odometry?.health === "suspect") {
      item.append(odometryAlert(id, odometry));
    }
    return item;
  });
  fillList($("vehicles"), items, "No vehicle is registered.");
  const ids = vehicles.map(({ id }) => id);
  if (ids.join() !== $("vehicle-ids").dataset.ids) {
    $("vehicle-ids").dataset.ids = ids.join();
    $("vehicle-ids").replaceChildren(...ids.map((id) => new Option(id, id)));
  }
}

function fixText({ pose, reason, alternatives }) {
  if (pose) {
    const degrees = (pose.yaw * 180) / Math.PI;
    return `${pose.x.toFixed(3)}, ${pose.y.toFixed(3)} m, ${degrees.toFixed(1)}°`;
  }
  return reason ? reason.replaceAll("_", " ") : `${alternatives.length} places`;
}

function showFixes() {
  const items = state.fixes.slice(-FIXES_LISTED).reverse()
    .map((fix) => listItem(fix.vehicle ?? "inline camera", fixText(fix), fix.status));
  fillList($("fixes"), items, "Nothing was localized yet.");
}

function chooseMap(name) {
  state.map = state.maps.find((map) => map.name === name && map.status === "ready") ?? null;
  state.since = 0;
  state.fixes = [];
  showFixes();
  const damaged = state.maps.find((map) => map.name === name && map.status === "error");
  $("map-facts").textContent = "";
  if (state.map) {
    const keypoints = state.map.layers.reduce((sum, layer) => sum + layer.keypoints, 0);
    $("map-facts").textContent = `${state.map.area_m2.toFixed(1)} m², ${keypoints.toLocaleString("en")} keypoints`;
    floor.show(state.map);
    showMessage(null);
  } else {
    floor.clear();
    showMessage(damaged ? `The map '${name}' cannot be shown: ${damaged.error}`
      : "The server has no map. Build one with floorloc-mapbuilder, put it into the maps folder and restart the server.");
  }
}

/// Loads the list of maps; resets the view when the server's maps have changed.
async function refreshMaps() {
  const maps = await api.listMaps();
  const key = maps.map(({ name, version, status }) => `${name} ${version} ${status}`).join();
  if (key === state.mapsKey) {
    return;
  }
  state.mapsKey = key;
  state.maps = maps;
  const chosen = state.map?.name ?? maps.find((map) => map.status === "ready")?.name ?? maps[0]?.name;
  $("map-choice").replaceChildren(...maps.map(({ name, status }) =>
    new Option(status === "ready" ? name : `${name} (damaged)`, name, false, name === chosen)));
  chooseMap(chosen);
}

async function refreshFixes() {
  const map = state.map;
  if (!map) {
    return;
  }
  const answer = await api.listFixes(map.name, state.since);
  if (map !== state.map) {
    return;
  }
  state.since = answer.next;
  if (answer.fixes.length > 0) {
    state.fixes = [...state.fixes, ...answer.fixes].slice(-FIXES_LISTED);
    floor.addFixes(answer.fixes);
    showFixes();
  }
}

async function refresh() {
  try {
    await refreshMaps();
    const vehicles = await api.listVehicles();
    showVehicles(vehicles);
    floor.showVehicles(vehicles.filter(({ map, pose }) => pose && map === state.map?.name));
    await refreshFixes();
    showConnection(null);
    if (state.away) {
      showMessage(null);
    }
    state.away = false;
  } catch (error) {
    state.away = true;
    showConnection(error);
    showMessage(error.message);
  }
}

async function poll() {
  await refresh();
  setTimeout(poll, POLL_MS);
}

function selectFile(file) {
  state.file = file ?? null;
  $("image-name").textContent = file ? file.name : "Drop a camera image here, or choose one";
}

async function localizeFile() {
  const vehicle = $("vehicle").value.trim();
  if (!state.map || !state.file || !vehicle) {
    $("answer").textContent = "Choose a map, an image and a registered vehicle first.";
    return;
  }
  $("localize").disabled = true;
  try {
    $("answer").textContent = JSON.stringify(await api.localize(state.map.name, vehicle, state.file), null, 1);
    await refresh();
  } catch (error) {
    $("answer").textContent = `${error.message} (${error.code})`;
  }
  $("localize").disabled = false;
}

$("map-choice").addEventListener("change", (event) => chooseMap(event.target.value));
$("image").addEventListener("change", (event) => selectFile(event.target.files[0]));
$("localize").addEventListener("click", localizeFile);
for (const type of ["dragover", "dragleave", "drop"]) {
  $("drop").addEventListener(type, (event) => {
    event.preventDefault();
    $("drop").classList.toggle("over", type === "dragover");
    if (type === "drop") {
      selectFile(event.dataTransfer.files[0]);
    }
  });
}
poll();
