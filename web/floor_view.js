// SPDX-License-Identifier: Apache-2.0
// The floor in metres: Leaflet with CRS.Simple, in which the map point (x, y) is LatLng [y, x].
import * as L from "/web/leaflet.esm.min.js";

import { tileTemplate } from "/web/api.js";

const FIXES_SHOWN = 60;
const COLOURS = { localized: "#128a5b", ambiguous: "#b97800", tracking_odometry: "#1f6fb2", lost: "#c0392b", stale: "#7d8a90" };
const EMPTY_TILE = "data:image/gif;base64,R0lGODlhAQABAAAAACH5BAEKAAEALAAAAAABAAEAAAICTAEAOw==";

/// Leaflet's zoom 0 is the mosaic's coarsest level, whose tiles are tile_px * resolution * 2^max_zoom metres wide.
function metricCrs(mosaic) {
  const pixelsPerMetre = 1 / (mosaic.resolution * 2 ** mosaic.max_zoom);
  return L.extend({}, L.CRS.Simple, { transformation: new L.Transformation(pixelsPerMetre, 0, -pixelsPerMetre, 0) });
}

/// Leaflet counts tile rows down from the origin; the server counts them up.
const MosaicLayer = L.TileLayer.extend({
  getTileUrl({ x, y, z }) {
    return L.Util.template(this._url, { x, y: -y - 1, z });
  },
});

/// Semi-axes (m) and direction (rad) of the position's 3-sigma ellipse; covariance: 3x3 of (x, y, yaw), row-major.
export function covarianceEllipse(covariance) {
  const [xx, xy, , , yy] = covariance;
  const mean = (xx + yy) / 2;
  const spread = Math.hypot((xx - yy) / 2, xy);
  return {
    major: 3 * Math.sqrt(Math.max(0, mean + spread)),
    minor: 3 * Math.sqrt(Math.max(0, mean - spread)),
    angle: Math.atan2(2 * xy, xx - yy) / 2,
  };
}

function ellipsePoints(pose) {
  const { major, minor, angle } = covarianceEllipse(pose.covariance);
  const points = [];
  for (let i = 0; i < 36; i += 1) {
    const t = (i / 36) * 2 * Math.PI;
    const a = major * Math.cos(t);
    const b = minor * Math.sin(t);
    points.push([
      pose.y + a * Math.sin(angle) + b * Math.cos(angle),
      pose.x + a * Math.cos(angle) - b * Math.sin(angle),
    ]);
  }
  return points;
}

/// Arrowhead centred at the pose, in map coordinates; length in metres.
function arrowPoints(pose, length) {
  const shape = [[0.6, 0], [-0.4, 0.32], [-0.2, 0], [-0.4, -0.32]];
  const c = Math.cos(pose.yaw) * length;
  const s = Math.sin(pose.yaw) * length;
  return shape.map(([x, y]) => [pose.y + s * x + c * y, pose.x + c * x - s * y]);
}

export class FloorView {
  constructor(element, onPosition) {
    this.element = element;
    this.onPosition = onPosition;
    this.fixes = [];
    this.vehicles = [];
  }

  /// Shows a map without fixes and vehicles; the caller adds them.
  show(map) {
    this.leaflet?.remove();
    this.fixes = [];
    this.vehicles = [];
    const { extent, mosaic } = map;
    const bounds = [[extent.y_min, extent.x_min], [extent.y_max, extent.x_max]];
    this.leaflet = L.map(this.element, {
      crs: metricCrs(mosaic),
      minZoom: -3,
      maxZoom: mosaic.max_zoom + 4,
      zoomSnap: 0.25,
      attributionControl: false,
      maxBounds: L.latLngBounds(bounds).pad(1),
    });
    new MosaicLayer(tileTemplate(map), {
      bounds,
      tileSize: mosaic.tile_px,
      minZoom: -3,
      minNativeZoom: 0,
      maxZoom: mosaic.max_zoom + 4,
      maxNativeZoom: mosaic.max_zoom,
      errorTileUrl: EMPTY_TILE,
    }).addTo(this.leaflet);
    this.drawn = L.layerGroup().addTo(this.leaflet);
    this.drawnVehicles = L.layerGroup().addTo(this.leaflet);
    L.control.scale({ imperial: false, maxWidth: 160 }).addTo(this.leaflet);
    this.leaflet.on("mousemove", ({ latlng }) => this.onPosition(latlng.lng, latlng.lat));
    this.leaflet.on("mouseout", () => this.onPosition(null, null));
    this.leaflet.on("zoomend", () => {
      this.draw();
      this.drawVehicles();
    });
    this.leaflet.fitBounds(bounds);
  }

  clear() {
    this.leaflet?.remove();
    this.leaflet = null;
  }

  addFixes(fixes) {
    this.fixes = [...this.fixes, ...fixes].slice(-FIXES_SHOWN);
    this.draw();
  }

  /// Vehicles with their fused poses.
  showVehicles(vehicles) {
    this.vehicles = vehicles;
    this.drawVehicles();
  }

  drawVehicles() {
    if (!this.leaflet) {
      return;
    }
    this.drawnVehicles.clearLayers();
    for (const { id, pose, status } of this.vehicles) {
      const colour = COLOURS[status];
      const around = { color: colour, weight: 1, fillOpacity: 0.12, className: "vehicle-ellipse" };
      const arrow = { color: "#ffffff", weight: 2, fillColor: colour, fillOpacity: 1 };
      L.polygon(ellipsePoints(pose), around).addTo(this.drawnVehicles);
      L.polygon(arrowPoints(pose, 44 * this.metresPerPixel()), { ...arrow, className: `vehicle-arrow ${status}` })
        .bindTooltip(`${id}: ${status.replaceAll("_", " ")}`)
        .addTo(this.drawnVehicles);
    }
  }

  metresPerPixel() {
    return this.leaflet.unproject([1, 0], this.leaflet.getZoom()).lng;
  }

  /// Redraws: old fixes fade, arrows keep their size on the screen.
  draw() {
    if (!this.leaflet) {
      return;
    }
    this.drawn.clearLayers();
    const metresPerPixel = this.metresPerPixel();
    this.fixes.forEach((fix, i) => {
      const opacity = 0.35 + (0.65 * (i + 1)) / this.fixes.length;
      const poses = fix.pose ? [fix.pose] : fix.alternatives;
      for (const pose of poses) {
        this.drawPose(pose, fix, { color: COLOURS[fix.status], opacity, fillOpacity: 0.85 * opacity, weight: 2 }, metresPerPixel);
      }
    });
  }

  drawPose(pose, fix, style, metresPerPixel) {
    if (pose.covariance) {
      L.polygon(ellipsePoints(pose), { ...style, fillOpacity: 0.15, className: "fix-ellipse" }).addTo(this.drawn);
    }
    L.polygon(arrowPoints(pose, 32 * metresPerPixel), { ...style, className: `fix-arrow ${fix.status}` })
      .bindTooltip(`${fix.vehicle ?? "inline camera"}: x ${pose.x.toFixed(3)} m, y ${pose.y.toFixed(3)} m`)
      .addTo(this.drawn);
  }
}
