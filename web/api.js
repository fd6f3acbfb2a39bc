// SPDX-License-Identifier: Apache-2.0
// Client of the HTTP API. Every failure is an ApiError with one sentence for people.

export class ApiError extends Error {
  constructor(message, code) {
    super(message);
    this.code = code;
  }
}

async function call(path, options = {}) {
  let response;
  try {
    response = await fetch(path, { cache: "no-store", ...options });
  } catch {
    throw new ApiError("The server does not answer. Is it running?", "away");
  }
  const body = await response.json().catch(() => null);
  if (!response.ok) {
    throw new ApiError(body?.detail ?? `The server answered with status ${response.status}.`, body?.code ?? "error");
  }
  return body;
}

const mapPath = (map) => `/v1/maps/${encodeURIComponent(map)}`;

export const listMaps = async () => (await call("/v1/maps")).maps;
export const listVehicles = async () => (await call("/v1/vehicles")).vehicles;
export const listFixes = (map, since) => call(`${mapPath(map)}/fixes?since=${since}`);

/// Leaflet fills in {z}, {x} and {y}.
export const tileTemplate = (map) => `${mapPath(map.name)}/tiles/{z}/{x}/{y}.jpg?v=${map.version}`;

export function localize(map, vehicle, file) {
  const path = `${mapPath(map)}/localize?vehicle=${encodeURIComponent(vehicle)}`;
  return call(path, { method: "POST", body: file, headers: { "Content-Type": file.type || "image/jpeg" } });
}
