// SPDX-License-Identifier: Apache-2.0
// Vehicles on the floor: one canvas of our own above Leaflet's tiles, drawn at the display's rate while anything moves.
import * as L from "/web/leaflet.esm.min.js";

import { drawInspection } from "/web/floor/inspection.js";
import { drawSuccess } from "/web/floor/success_layer.js";
import { Sprites, floorColours } from "/web/floor/sprites.js";
import { drawAlternatives, drawFixes, drawInitialPose, drawTrail, putLabel, styleLabels } from "/web/floor/details.js";

const TEXT_PX = 15; // of the page for which the sizes below are
const LARGE_PX = 30;
const SMALL_PX = 17;
const MANY = 300; // vehicles in view from which on arrows are small
const LABELLED = 100; // vehicles in view below which they have labels
const SMALLEST_ELLIPSE_PX = 3;
const REACH_PX = 20; // of a click
const REST_MS = 2000; // without news and motion of the view nothing is drawn
const FIXES_OF_CHOSEN = 30;
const FRAMES_TIMED = 120;
const FADED = { stale: 0.75 };

export const FleetLayer = L.Layer.extend({
  /// scene: {vehicles(), loose(), chosen(), initialPose(), inspection(), success(), showTrail} of the map that is shown.
  initialize(scene) {
    this.scene = scene;
    this.drawn = []; // {vehicle, x, y, yaw} of the last frame; the first this.inView are valid
    this.inView = 0;
    this.pose = { x: 0, y: 0, yaw: 0 };
    this.stats = { frames: 0, vehicles: 0, labels: 0, ellipses: 0 };
    this.frameMs = new Float32Array(FRAMES_TIMED); // a ring: script of the last frames
    this.wakeUntil = 0;
  },

  onAdd(map) {
    this.map = map;
    this.canvas = L.DomUtil.create("canvas", "fleet leaflet-zoom-animated", map.getPane("markerPane"));
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "Vehicles on the floor; the list of vehicles says the same");
    this.context = this.canvas.getContext("2d");
    this.prepareSprites();
    map.on({ move: this.wake, resize: this.wake, zoomend: this.wake, zoomanim: this.animateZoom }, this);
    this.wake();
  },

  onRemove(map) {
    map.off({ move: this.wake, resize: this.wake, zoomend: this.wake, zoomanim: this.animateZoom }, this);
    cancelAnimationFrame(this.request);
    this.canvas.remove();
    this.map = null;
  },

  /// The sprites of this display: on a wall with large text they are large, too.
  prepareSprites() {
    this.scale = window.devicePixelRatio || 1;
    this.size = parseFloat(getComputedStyle(document.documentElement).fontSize) / TEXT_PX;
    this.colours = floorColours();
    this.large = new Sprites(LARGE_PX * this.size, this.scale, this.colours);
    this.small = new Sprites(SMALL_PX * this.size, this.scale, this.colours);
  },

  /// Draws from now on, until nothing has come for a while.
  wake() {
    this.wakeUntil = performance.now() + REST_MS;
    this.drawSoon();
  },

  /// Draws one frame.
  drawSoon() {
    this.request ??= requestAnimationFrame((time) => this.frame(time));
  },

  /// As Leaflet's renderers: the old drawing is scaled until the zoom has ended.
  animateZoom({ center, zoom }) {
    const map = this.map;
    const scale = map.getZoomScale(zoom, map.getZoom());
    const corner = map.project(map.containerPointToLatLng([0, 0]), zoom);
    const offset = corner.subtract(map._getNewPixelOrigin(center, zoom));
    L.DomUtil.setTransform(this.canvas, offset, scale);
  },

  frame(time) {
    this.request = null;
    if (!this.map) {
      return;
    }
    const start = performance.now();
    this.scene.beforeFrame?.(time);
    if (!this.map._animatingZoom) {
      this.draw();
    }
    this.frameMs[this.stats.frames % FRAMES_TIMED] = performance.now() - start;
    this.stats.frames += 1;
    if (time < this.wakeUntil) {
      this.drawSoon();
    }
  },

  /// Pixels from metres: x = k * x + ox, y = oy - k * y in the container.
  project() {
    const { map } = this;
    const pane = L.DomUtil.getPosition(map.getPane("mapPane")) ?? { x: 0, y: 0 };
    const origin = map.project([0, 0]).subtract(map.getPixelOrigin()).add(pane);
    return { k: map.project([0, 1]).x - map.project([0, 0]).x, ox: origin.x, oy: origin.y };
  },

  prepare() {
    if (this.scale !== (window.devicePixelRatio || 1)) {
      this.prepareSprites();
    }
    const { canvas, context, scale, map } = this;
    const { x: width, y: height } = map.getSize();
    if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
      canvas.width = Math.round(width * scale);
      canvas.height = Math.round(height * scale);
      canvas.style.width = `${width}px`;
      canvas.style.height = `${height}px`;
    }
    L.DomUtil.setPosition(canvas, map.containerPointToLayerPoint([0, 0]));
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, width, height);
    return { width, height };
  },

  draw() {
    const size = this.prepare();
    const to = this.project();
    this.place(to, size);
    const chosen = this.scene.chosen();
    const success = this.scene.success();
    if (success) {
      drawSuccess(this.context, to, success, this.colours);
    }
    const inspection = this.scene.inspection();
    if (inspection) {
      drawInspection(this.context, to, inspection, this.colours);
    }
    if (chosen && this.scene.showTrail) {
      drawTrail(this.context, to, chosen, this.colours);
    }
    drawFixes(this.context, to, this.scene.loose(), this.colours);
    if (chosen) {
      drawFixes(this.context, to, chosen.fixes.slice(-FIXES_OF_CHOSEN), this.colours);
    }
    this.drawEllipses(to.k);
    this.drawArrows(chosen);
    this.drawLabels(chosen);
    const ambiguous = (vehicle) => vehicle.state === "ambiguous" && (vehicle === chosen || this.inView < LABELLED);
    for (const vehicle of this.scene.vehicles()) {
      if (ambiguous(vehicle)) {
        drawAlternatives(this.context, to, vehicle, this.colours);
      }
    }
    if (this.scene.initialPose()) {
      drawInitialPose(this.context, to, this.scene.initialPose(), this.colours);
    }
  },

  /// Where the vehicles in view are now.
  place({ k, ox, oy }, { width, height }) {
    const now = performance.timeOrigin / 1000 + performance.now() / 1000;
    this.inView = 0;
    for (const vehicle of this.scene.vehicles()) {
      if (!vehicle.motion.at(now, this.pose)) {
        continue;
      }
      const x = k * this.pose.x + ox;
      const y = oy - k * this.pose.y;
      if (x > -LARGE_PX && y > -LARGE_PX && x < width + LARGE_PX && y < height + LARGE_PX) {
        const entry = (this.drawn[this.inView] ??= {});
        entry.vehicle = vehicle;
        entry.x = x;
        entry.y = y;
        entry.yaw = this.pose.yaw;
        this.inView += 1;
      }
    }
    this.stats.vehicles = this.inView;
  },

  /// 3-sigma ellipses, of doubtful poses always; one path per state.
  drawEllipses(k) {
    const paths = new Map();
    let count = 0;
    for (let i = 0; i < this.inView; i += 1) {
      const { vehicle, x, y } = this.drawn[i];
      const { major, minor, angle } = vehicle.ellipse;
      const doubtful = vehicle.state === "lost" || vehicle.state === "ambiguous";
      if (major * k > SMALLEST_ELLIPSE_PX || doubtful) {
        const path = paths.get(vehicle.state) ?? new Path2D();
        paths.set(vehicle.state, path);
        const a = Math.min(1e4, Math.max(major * k, doubtful ? 14 : 0));
        const b = Math.min(1e4, Math.max(minor * k, doubtful ? 14 : 0));
        path.moveTo(x + a * Math.cos(angle), y - a * Math.sin(angle));
        path.ellipse(x, y, a, b, -angle, 0, 2 * Math.PI);
        count += 1;
      }
    }
    this.stats.ellipses = count;
    for (const [state, path] of paths) {
      this.context.fillStyle = this.colours[state];
      this.context.strokeStyle = this.colours[state];
      this.context.globalAlpha = 0.16;
      this.context.fill(path);
      this.context.globalAlpha = 0.9;
      this.context.lineWidth = 1.2;
      this.context.stroke(path);
    }
    this.context.globalAlpha = 1;
  },

  drawArrows(chosen) {
    const sprites = this.inView > MANY ? this.small : this.large;
    let alpha = 1;
    for (let i = 0; i < this.inView; i += 1) {
      const { vehicle, x, y, yaw } = this.drawn[i];
      const wanted = FADED[vehicle.state] ?? 1;
      if (wanted !== alpha) {
        this.context.globalAlpha = wanted;
        alpha = wanted;
      }
      if (vehicle === chosen) {
        this.drawHalo(x, y);
      }
      (vehicle === chosen ? this.large : sprites).draw(this.context, vehicle.state, x, y, yaw);
    }
    this.context.globalAlpha = 1;
  },

  drawHalo(x, y) {
    this.context.lineWidth = 5;
    for (const colour of [this.colours.panel, this.colours.accent]) {
      this.context.beginPath();
      this.context.arc(x, y, 0.66 * this.large.size, 0, 2 * Math.PI);
      this.context.strokeStyle = colour;
      this.context.stroke();
      this.context.lineWidth = 2.5;
    }
  },

  drawLabels(chosen) {
    const { context } = this;
    const all = this.inView < LABELLED;
    styleLabels(context, this.colours, 12 * this.size);
    this.stats.labels = 0;
    for (let i = 0; i < this.inView; i += 1) {
      const { vehicle, x, y } = this.drawn[i];
      if (all || vehicle === chosen) {
        putLabel(context, vehicle.state === "stale" ? `${vehicle.id} (silent)` : vehicle.id, x + 19 * this.size, y);
        this.stats.labels += 1;
      }
    }
  },

  /// The vehicle at a point of the container, or null.
  vehicleAt({ x, y }) {
    let best = null;
    let least = REACH_PX;
    for (let i = 0; i < this.inView; i += 1) {
      const distance = Math.hypot(this.drawn[i].x - x, this.drawn[i].y - y);
      if (distance < least) {
        least = distance;
        best = this.drawn[i].vehicle;
      }
    }
    return best;
  },
});
