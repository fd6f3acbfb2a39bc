// SPDX-License-Identifier: Apache-2.0
// The map of the report: layers, pan and zoom by the SVG's viewBox, the place under the pointer.
"use strict";

const map = document.getElementById("map");
const cells = JSON.parse(document.getElementById("cells").textContent);
const home = map.viewBox.baseVal;
const whole = { x: home.x, y: home.y, width: home.width, height: home.height };
const SMALLEST_SHARE = 0.01;
let view = { ...whole };

function show(next) {
  const width = Math.min(Math.max(next.width, whole.width * SMALLEST_SHARE), whole.width * 1.5);
  const height = width * whole.height / whole.width;
  const keep = (low, size, first, length) => Math.min(Math.max(low, first - size / 2), first + length - size / 2);
  view = { width, height, x: keep(next.x, width, whole.x, whole.width), y: keep(next.y, height, whole.y, whole.height) };
  map.setAttribute("viewBox", `${view.x} ${view.y} ${width} ${height}`);
  map.style.setProperty("--zoom", width / whole.width);
}

function zoom(factor, x = view.x + view.width / 2, y = view.y + view.height / 2) {
  const width = Math.min(Math.max(view.width * factor, whole.width * SMALLEST_SHARE), whole.width * 1.5);
  const share = width / view.width;
  show({ x: x - (x - view.x) * share, y: y - (y - view.y) * share, width });
}

/// Where a pointer event is in the drawing: metres from (cells.x_of_0, cells.y_of_0) of the map, y down.
function place(event) {
  const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(map.getScreenCTM().inverse());
  return { x: p.x, y: p.y };
}

function goTo(zone) {
  const { size } = zone.dataset;
  const x = Number(zone.dataset.x) - cells.x_of_0;
  const y = cells.y_of_0 - Number(zone.dataset.y);
  const width = Math.max(Number(size) * 4, whole.width * 0.15);
  show({ x: x - width / 2, y: y - width * whole.height / whole.width / 2, width });
}

// --- pointers: one pans, two pinch ---

const pointers = new Map();
map.addEventListener("pointerdown", (event) => {
  pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  map.setPointerCapture(event.pointerId);
  map.classList.add("dragging");
});
map.addEventListener("pointermove", (event) => {
  readOut(event);
  const last = pointers.get(event.pointerId);
  if (!last) {
    return;
  }
  const scale = map.getScreenCTM().a;
  const now = { x: event.clientX, y: event.clientY };
  const others = [...pointers].filter(([id]) => id !== event.pointerId).map(([, p]) => p);
  if (others.length > 0) {
    const distance = (p) => Math.hypot(p.x - others[0].x, p.y - others[0].y);
    const at = place(event);
    zoom(distance(last) / Math.max(distance(now), 1), at.x, at.y);
  } else {
    show({ ...view, x: view.x - (now.x - last.x) / scale, y: view.y - (now.y - last.y) / scale });
  }
  pointers.set(event.pointerId, now);
});
for (const end of ["pointerup", "pointercancel"]) {
  map.addEventListener(end, (event) => {
    pointers.delete(event.pointerId);
    map.classList.toggle("dragging", pointers.size > 0);
  });
}
// The page scrolls past the map; the wheel zooms once the map has been clicked, or with the control key.
map.addEventListener("wheel", (event) => {
  if (document.activeElement === map || event.ctrlKey) {
    event.preventDefault();
    const at = place(event);
    zoom(Math.exp(event.deltaY * 0.0015), at.x, at.y);
  }
}, { passive: false });
map.addEventListener("keydown", (event) => {
  const step = view.width / 8;
  const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
  if (moves[event.key]) {
    show({ ...view, x: view.x + moves[event.key][0], y: view.y + moves[event.key][1] });
  } else if (event.key === "+" || event.key === "=") {
    zoom(0.7);
  } else if (event.key === "-") {
    zoom(1 / 0.7);
  } else if (event.key === "0" || event.key === "Escape") {
    show(whole);
  } else {
    return;
  }
  event.preventDefault();
});
document.getElementById("zoom-in").addEventListener("click", () => zoom(0.6));
document.getElementById("zoom-out").addEventListener("click", () => zoom(1 / 0.6));
document.getElementById("zoom-all").addEventListener("click", () => show(whole));

// --- layers ---

function applyLayers() {
  for (const input of document.querySelectorAll("#layers input")) {
    const layer = document.getElementById(`on-map-${input.value}`);
    if (layer) {
      layer.style.display = input.checked ? "" : "none";
    }
    const legend = document.getElementById(`legend-${input.value}`);
    if (legend) {
      legend.hidden = !input.checked;
    }
  }
}
document.getElementById("layers").addEventListener("change", applyLayers);
for (const card of document.querySelectorAll("[data-show]")) {
  card.addEventListener("click", () => {
    document.querySelector(`#layers input[value="${card.dataset.show}"]`).checked = true;
    applyLayers();
    document.getElementById("map-section").scrollIntoView({ behavior: "smooth" });
  });
}
for (const row of document.querySelectorAll("[data-zone-row]")) {
  row.querySelector("button").addEventListener("click", () => {
    goTo(row);
    document.getElementById("map-section").scrollIntoView({ behavior: "smooth" });
  });
}

// --- the place under the pointer ---

const decode = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
const coverage = decode(cells.coverage);
const usable = new Uint16Array(decode(cells.usable).buffer);

function readOut(event) {
  const drawn = place(event);
  const x = cells.x_of_0 + drawn.x;
  const y = cells.y_of_0 - drawn.y;
  let text = `x ${x.toFixed(3)} m, y ${y.toFixed(3)} m`;
  const column = Math.floor((x - cells.x_min) / cells.cell_m);
  const row = Math.floor((y - cells.y_min) / cells.cell_m);
  if (column >= 0 && column < cells.columns && row >= 0 && row < cells.rows) {
    const cell = row * cells.columns + column;
    const frames = coverage[cell] === 255 ? "255 or more" : coverage[cell];
    text += coverage[cell] > 0 ? `: seen by ${frames} frame${coverage[cell] === 1 ? "" : "s"}` : ": not surveyed";
    if (usable[cell] < cells.not_judged) {
      text += `, ${usable[cell]} usable keypoints in view`;
    }
  }
  document.getElementById("readout").textContent = text;
}

applyLayers();
show(whole);
