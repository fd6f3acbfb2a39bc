// SPDX-License-Identifier: Apache-2.0
// Stands before a real server and answers for its vehicles and events, so that a test can have any fleet.
import { once } from "node:events";
import { createServer } from "node:http";

const STREAM_HEAD = { "Content-Type": "text/event-stream", "Cache-Control": "no-store" };

/// A vehicle as GET /v1/vehicles lists it. extra: fields that differ; sigma: of the position, metres.
export function makeVehicle(id, { x, y, yaw = 0, sigma = 0.001 }, extra = {}) {
  const stamp = Date.now() / 1000;
  const covariance = [sigma ** 2, 0, 0, 0, sigma ** 2, 0, 0, 0, 1e-4];
  const pose = { map: "sample", map_version: "0", frame: "map", stamp, x, y, yaw, covariance };
  return {
    id, map: "sample", status: "localized", pose, epoch: 0, silent_s: 0, last_heard: stamp, odometry: null,
    camera_status: "as_calibrated", last_fix: null, ...extra,
  };
}

export class Stub {
  /// upstream: URL of the server behind. overrides: path -> (answer of the server) => answer, besides.
  constructor(upstream, overrides = {}) {
    this.upstream = upstream;
    this.overrides = overrides;
    this.vehicles = [];
    this.streams = new Set();
    this.nextId = 1;
  }

  async start() {
    this.server = createServer((request, response) =>
      this.answer(request, response).catch((error) => response.writeHead(502).end(String(error))));
    this.server.listen(0, "127.0.0.1");
    await once(this.server, "listening");
    this.url = `http://127.0.0.1:${this.server.address().port}`;
    return this;
  }

  async stop() {
    this.server.closeAllConnections();
    this.server.close();
    await once(this.server, "close");
  }

  async answer(request, response) {
    const { pathname } = new URL(request.url, this.url);
    if (pathname === "/v1/events") {
      response.writeHead(200, STREAM_HEAD);
      response.write(": hello\n\n");
      this.streams.add(response);
      request.on("close", () => this.streams.delete(response));
    } else if (pathname === "/v1/vehicles") {
      response.writeHead(200, { "Content-Type": "application/json" });
      response.end(JSON.stringify({ vehicles: this.vehicles }));
    } else {
      await this.forward(request, response, pathname);
    }
  }

  async forward(request, response, pathname) {
    const body = [];
    for await (const part of request) {
      body.push(part);
    }
    const { host, connection, ...headers } = request.headers;
    const answer = await fetch(this.upstream + request.url,
      { method: request.method, headers, body: body.length > 0 ? Buffer.concat(body) : undefined });
    let bytes = Buffer.from(await answer.arrayBuffer());
    let { status } = answer;
    if (this.overrides[pathname]) {
      bytes = Buffer.from(JSON.stringify(this.overrides[pathname](status === 200 ? JSON.parse(bytes) : null)));
      status = 200;
    }
    response.writeHead(status, Object.fromEntries([...answer.headers].filter(([name]) =>
      !["content-length", "content-encoding", "transfer-encoding", "connection", "keep-alive"].includes(name))));
    response.end(bytes);
  }

  /// Sends an event to all viewers, or several: [[name, data], ...].
  emit(...events) {
    let text = "";
    for (const [name, data] of events) {
      text += `id: ${this.nextId}\nevent: ${name}\ndata: ${JSON.stringify(data)}\n\n`;
      this.nextId += 1;
    }
    this.streams.forEach((stream) => stream.write(text));
  }

  emitPose({ id, map, status, pose, epoch }) {
    this.emit(["pose", { vehicle: id, map, status, pose, epoch, silent_s: 0 }]);
  }
}

let sequence = 0;
/// An event "fix" of a vehicle. extra: status, accepted, alternatives, ...
export function makeFix({ id, map, pose }, extra = {}) {
  sequence += 1;
  return ["fix", {
    sequence, received: Date.now() / 1000, stamp: Date.now() / 1000, vehicle: id, map, status: "localized", pose,
    fix: { keypoints: 480, matches: 210, inliers: 171, rms_m: 0.0004, p_wrong: 1e-9, search: "prior" },
    alternatives: [], accepted: true, reanchored: false, ...extra,
  }];
}
