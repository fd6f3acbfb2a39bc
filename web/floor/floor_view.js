// SPDX-License-Identifier: Apache-2.0
// The floor in metres: Leaflet with CRS.Simple, in which the map point (x, y) is LatLng [y, x].
import * as L from "/web/leaflet.esm.min.js";

import { fetchTile, getToken, tileTemplate } from "/web/data/api.js";
import { FleetLayer } from "/web/floor/fleet_layer.js";

const EMPTY_TILE = "data:image/gif;base64,R0lGODlhAQABAAAAACH5BAEKAAEALAAAAAABAAEAAAICTAEAOw==";
const ZOOMS_BEYOND = 4; // of the finest level, enlarged

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

  createTile(coords, done) {
    return getToken() ? this.fetchedTile(coords, done) : L.TileLayer.prototype.createTile.call(this, coords, done);
  },

  fetchedTile(coords, done) {
    const tile = L.DomUtil.create("img");
    tile.alt = "";
    fetchTile(this.getTileUrl(coords)).then((blob) => {
      tile.addEventListener("load", () => {
        URL.revokeObjectURL(tile.src);
        done(null, tile);
      }, { once: true });
      tile.src = URL.createObjectURL(blob);
    }, () => {
      tile.src = EMPTY_TILE;
      done(null, tile);
    });
    return tile;
  },
});

export class FloorView {
  /// handlers: onPosition(x, y) with nulls outside, onChoose(vehicle), onUserMove(); scene: see FleetLayer.
  constructor(element, scene, handlers) {
    this.element = element;
    this.scene = scene;
    this.handlers = handlers;
    this.tooltip = element.parentElement.querySelector(".tooltip");
    new ResizeObserver(() => this.leaflet?.invalidateSize({ animate: false })).observe(element);
  }

  /// Shows a map; the view stays when it is another version of the one that is shown.
  show(map) {
    const kept = this.map?.id === map.id && this.leaflet ? { center: this.leaflet.getCenter(), zoom: this.leaflet.getZoom() } : null;
    this.clear();
    this.map = map;
    const { extent, mosaic } = map;
    this.bounds = L.latLngBounds([[extent.y_min, extent.x_min], [extent.y_max, extent.x_max]]);
    this.leaflet = L.map(this.element, {
      crs: metricCrs(mosaic),
      minZoom: -3,
      maxZoom: mosaic.max_zoom + ZOOMS_BEYOND,
      zoomSnap: 0.25,
      attributionControl: false,
      maxBounds: this.bounds.pad(5), // so that a vehicle at the edge of a narrow floor can be in the middle
    });
    this.leaflet.getPane("tilePane").setAttribute("aria-hidden", "true");
    this.addLayers(map);
    this.listen();
    if (kept) {
      this.leaflet.setView(kept.center, kept.zoom, { animate: false });
    } else {
      this.leaflet.fitBounds(this.bounds, { animate: false });
    }
  }

  addLayers(map) {
    const { mosaic } = map;
    new MosaicLayer(tileTemplate(map), {
      bounds: this.bounds,
      tileSize: mosaic.tile_px,
      minZoom: -3,
      minNativeZoom: 0,
      maxZoom: mosaic.max_zoom + ZOOMS_BEYOND,
      maxNativeZoom: mosaic.max_zoom,
      errorTileUrl: EMPTY_TILE,
    }).addTo(this.leaflet);
    this.fleet = new FleetLayer(this.scene).addTo(this.leaflet);
    L.control.scale({ imperial: false, maxWidth: 160 }).addTo(this.leaflet);
  }

  listen() {
    this.leaflet.on("mousemove", ({ latlng, containerPoint }) => {
      this.handlers.onPosition(latlng.lng, latlng.lat);
      this.showTooltip(containerPoint);
    });
    this.leaflet.on("mouseout", () => {
      this.handlers.onPosition(null, null);
      this.tooltip.hidden = true;
    });
    this.leaflet.on("click", ({ containerPoint }) => this.handlers.onChoose(this.fleet.vehicleAt(containerPoint)));
    this.leaflet.on("dragstart", () => this.handlers.onUserMove());
  }

  showTooltip(point) {
    const vehicle = this.fleet.vehicleAt(point);
    this.tooltip.hidden = !vehicle;
    this.element.classList.toggle("over-vehicle", Boolean(vehicle));
    if (vehicle) {
      this.tooltip.textContent = this.handlers.sayVehicle(vehicle);
      this.tooltip.style.left = `${Math.min(point.x + 14, this.element.clientWidth - this.tooltip.offsetWidth - 4)}px`;
      this.tooltip.style.top = `${point.y + 14}px`;
    }
  }

  clear() {
    this.leaflet?.remove();
    this.leaflet = null;
    this.fleet = null;
    this.map = null;
    this.tooltip.hidden = true;
  }

  /// Something moves.
  wake() {
    this.fleet?.wake();
  }

  /// Something changed that is drawn.
  redraw() {
    this.fleet?.drawSoon();
  }

  /// Moves so that the pose is in the middle.
  goTo({ x, y }) {
    this.leaflet.setView([y, x], this.leaflet.getZoom(), { animate: false });
  }

  /// Moves so that all points are seen, with some floor around them.
  lookAt(points) {
    this.leaflet.fitBounds(L.latLngBounds(points.map(({ x, y }) => [y, x])).pad(0.25), { animate: false });
  }

  /// Moves where the pose is out of sight only.
  bringIntoView({ x, y }) {
    if (!this.leaflet.getBounds().pad(-0.05).contains([y, x])) {
      this.goTo({ x, y });
    }
  }

  fit() {
    this.leaflet?.fitBounds(this.bounds);
  }

  metresAt(event) {
    const { lat, lng } = this.leaflet.mouseEventToLatLng(event);
    return { x: lng, y: lat };
  }
}
