// SPDX-License-Identifier: Apache-2.0
// Arrows of vehicles, turned beforehand: one image with a row per state and a column per heading.
import { STATES } from "/web/words.js";

const HEADINGS = 96;
const ROWS = Object.keys(STATES);

/// A colour of theme.css for canvases: that of the light theme always, as the floor below has no theme.
function floorColour(name) {
  const probe = document.createElement("span");
  probe.style.colorScheme = "light";
  probe.style.color = `var(--${name})`;
  document.body.append(probe);
  const { color } = getComputedStyle(probe);
  probe.remove();
  return color;
}

export const floorColours = () =>
  Object.fromEntries([...ROWS, "ink", "panel", "accent"].map((name) => [name, floorColour(name)]));

/// Arrowhead around the origin, pointing along +x, of the given length.
export function arrowPath(context, length) {
  context.beginPath();
  [[0.6, 0], [-0.4, 0.34], [-0.2, 0], [-0.4, -0.34]].forEach(([x, y]) => context.lineTo(x * length, y * length));
  context.closePath();
}

export function crossPath(context, r) {
  context.beginPath();
  context.moveTo(-r, -r);
  context.lineTo(r, r);
  context.moveTo(r, -r);
  context.lineTo(-r, r);
}

function markState(context, state, size) {
  context.lineWidth = Math.max(1.4, size / 14);
  const r = size / 6;
  context.beginPath();
  if (state === "lost") {
    crossPath(context, r);
  } else if (state === "tracking_odometry") {
    context.moveTo(-0.16 * size, 0);
    context.lineTo(0.3 * size, 0);
  } else if (state === "ambiguous") {
    context.arc(0, 0, 0.8 * r, 0, 2 * Math.PI);
  }
  context.stroke();
}

/// Filled where the pose is known; hollow where the vehicle may be anywhere; lost: crossed; odometry: with a line.
function drawArrow(context, state, size, colours) {
  const hollow = state === "stale";
  arrowPath(context, size * 0.78);
  context.lineJoin = "round";
  context.lineWidth = Math.max(2, size / 9);
  context.strokeStyle = hollow ? colours[state] : "#ffffff";
  context.fillStyle = hollow ? "rgba(255, 255, 255, 0.45)" : colours[state];
  context.stroke();
  context.fill();
  context.strokeStyle = "#ffffff";
  markState(context, state, size);
}

export class Sprites {
  /// size: of a sprite, CSS pixels; scale: device pixels of one.
  constructor(size, scale, colours) {
    this.size = size;
    this.cell = Math.ceil(size * scale);
    const canvas = new OffscreenCanvas(this.cell * HEADINGS, this.cell * ROWS.length);
    const context = canvas.getContext("2d");
    ROWS.forEach((state, row) => {
      for (let i = 0; i < HEADINGS; i += 1) {
        context.setTransform(scale, 0, 0, scale, (i + 0.5) * this.cell, (row + 0.5) * this.cell);
        context.rotate((-2 * Math.PI * i) / HEADINGS);
        drawArrow(context, state, size, colours);
      }
    });
    this.image = canvas.transferToImageBitmap();
    this.rows = Object.fromEntries(ROWS.map((state, row) => [state, row * this.cell]));
  }

  /// x, y: on the canvas, CSS pixels; yaw: counter-clockwise on the screen.
  draw(context, state, x, y, yaw) {
    const turns = yaw / (2 * Math.PI);
    const column = Math.round((turns - Math.floor(turns)) * HEADINGS) % HEADINGS;
    context.drawImage(this.image, column * this.cell, this.rows[state] ?? 0, this.cell, this.cell,
      x - this.size / 2, y - this.size / 2, this.size, this.size);
  }
}
