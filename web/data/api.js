// SPDX-License-Identifier: Apache-2.0
// Client of the HTTP API. Every failure is an ApiError with one sentence for people.

export class ApiError extends Error {
  constructor(message, code) {
    super(message);
    this.code = code;
  }
}

const TOKEN_KEY = "floorloc-token";

/// The token stays in this tab.
export const getToken = () => sessionStorage.getItem(TOKEN_KEY) ?? "";
export const setToken = (token) => (token ? sessionStorage.setItem(TOKEN_KEY, token) : sessionStorage.removeItem(TOKEN_KEY));
export const authorization = () => (getToken() ? { Authorization: `Bearer ${getToken()}` } : {});

const AWAY = "The server does not answer. Is it running?";

/// Told when a call wants another token.
export const onUnauthorized = { call: () => {} };

function problem(status, body) {
  if (status === 401) {
    onUnauthorized.call();
  }
  return new ApiError(body?.detail ?? `The server answered with status ${status}.`, body?.code ?? "error");
}

async function request(path, { headers, ...options } = {}) {
  let response;
  try {
    response = await fetch(path, { cache: "no-store", ...options, headers: { ...authorization(), ...headers } });
  } catch (error) {
    throw error.name === "AbortError" ? error : new ApiError(AWAY, "away");
  }
  if (!response.ok) {
    throw problem(response.status, await response.json().catch(() => null));
  }
  return response;
}

const call = async (path, options) => (await request(path, options)).json();
const send = (path, body) =>
  call(path, { method: "POST", body: JSON.stringify(body), headers: { "Content-Type": "application/json" } });

const mapPath = (map) => `/v1/maps/${encodeURIComponent(map)}`;
const vehiclePath = (id) => `/v1/vehicles/${encodeURIComponent(id)}`;

export const listMaps = async () => (await call("/v1/maps")).maps;
export const listVehicles = async () => (await call("/v1/vehicles")).vehicles;
export const getVehicle = (id) => call(vehiclePath(id));
export const getLastFrame = (id) => call(`${vehiclePath(id)}/last_frame`);
export const getDiagnosis = (id) => call(`${vehiclePath(id)}/diagnosis`);
export const getMap = (map) => call(mapPath(map));
export const getQuality = (map) => call(`${mapPath(map)}/quality`);
export const getSuccess = (map) => call(`${mapPath(map)}/success`);
export const listFixes = async (map) => (await call(`${mapPath(map)}/fixes`)).fixes;
export const setPose = (id, pose) => send(`${vehiclePath(id)}/initialpose`, pose);

export const listVersions = (map) => call(`${mapPath(map)}/versions`);
export const activateVersion = (map, version) => call(`${mapPath(map)}/versions/${version}/activate`, { method: "POST" });
export const deleteVersion = (map, version) => request(`${mapPath(map)}/versions/${version}`, { method: "DELETE" });

/// The stream of events: a Response whose body goes on.
export const openEvents = (lastId, signal) =>
  request("/v1/events", { signal, headers: lastId ? { "Last-Event-ID": lastId } : {} });

/// Leaflet fills in {z}, {x} and {y}.
export const tileTemplate = (map) => `${mapPath(map.name)}/tiles/{z}/{x}/{y}.jpg?v=${map.version}`;
/// With a token a tile is fetched; an image element could not send it.
export const fetchTile = async (url, signal) => (await request(url, { signal, cache: "default" })).blob();

export function localize(map, vehicle, file) {
  const path = `${mapPath(map)}/localize?inspect=true&vehicle=${encodeURIComponent(vehicle)}`;
  return call(path, { method: "POST", body: file, headers: { "Content-Type": file.type || "image/jpeg" } });
}

/// Uploads a map file; progress gets the share that was sent. Only XMLHttpRequest tells that.
export function uploadVersion(map, file, activate, progress) {
  return new Promise((resolve, reject) => {
    const upload = new XMLHttpRequest();
    upload.open("POST", `${mapPath(map)}/versions?activate=${activate}`);
    upload.responseType = "json";
    for (const [name, value] of Object.entries({ "Content-Type": "application/vnd.sqlite3", ...authorization() })) {
      upload.setRequestHeader(name, value);
    }
    upload.upload.addEventListener("progress", (event) => progress(event.loaded / Math.max(1, event.total)));
    upload.addEventListener("error", () => reject(new ApiError(AWAY, "away")));
    upload.addEventListener("load", () =>
      (upload.status < 300 ? resolve(upload.response) : reject(problem(upload.status, upload.response))));
    upload.send(file);
  });
}
