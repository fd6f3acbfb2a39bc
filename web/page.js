// SPDX-License-Identifier: Apache-2.0
// The page: takes lists and events from the server, and shows them.
import { AlertList } from "/web/panels/alerts.js";
import * as api from "/web/data/api.js";
import { $, setText } from "/web/dom.js";
import { EventFeed } from "/web/data/events.js";
import { Fleet } from "/web/data/fleet.js";
import { FloorView } from "/web/floor/floor_view.js";
import { cornersOf } from "/web/floor/inspection.js";
import { drawPoses } from "/web/panels/initial_pose.js";
import { Inspector } from "/web/panels/inspector.js";
import { MapList, rankMaps } from "/web/panels/map_list.js";
import { MapVersions } from "/web/panels/map_versions.js";
import { Replay } from "/web/panels/replay.js";
import { Success } from "/web/panels/success.js";
import { TokenDialog, initTheme, readView, writeView } from "/web/panels/settings.js";
import { TryIt } from "/web/panels/try_it.js";
import { VehicleList } from "/web/panels/vehicle_list.js";
import { VehiclePanel } from "/web/panels/vehicle_panel.js";
import { STATES } from "/web/words.js";

const LISTS_MS = 500; // between two looks at lists and panel
const PANEL_MS = 100; // between two looks at the panel of a drive that is replayed
const RESYNC_MS = 60000; // the lists are asked for again, in case an event was missed

const now = () => Date.now() / 1000;

class Page {
  constructor() {
    this.view = readView();
    this.fleet = new Fleet();
    this.onMap = { map: null, revision: -1, vehicles: [] };
    this.follow = false;
    this.scene = {
      vehicles: () => this.vehiclesOnMap(),
      loose: () => (this.replay.drive ? [] : this.fleet.loose.get(this.view.map) ?? []),
      chosen: () => this.chosen(),
      initialPose: () => this.chosen()?.initialPose,
      inspection: () => this.inspector.scene(),
      success: () => this.success.scene(),
      beforeFrame: () => {
        this.replay.tick();
        this.followChosen();
      },
      showTrail: true,
    };
    this.inspector = new Inspector({
      onChange: () => this.floor.redraw(),
      onLook: (inspection, pose) => {
        this.setFollow(false);
        this.floor.lookAt(cornersOf(inspection, pose));
      },
    });
    this.success = new Success({
      onChange: () => this.floor.redraw(),
      onLook: (points) => this.floor.leaflet && this.floor.lookAt(points),
      onToggle: (open) => this.change({ layer: open ? "success" : "" }),
    });
    this.replay = new Replay({
      onOpen: (drive) => this.openDrive(drive),
      onTime: () => this.showReplay(),
      onClose: () => this.closeDrive(),
    });
    this.floor = new FloorView($("floor"), this.scene, {
      onPosition: (x, y) => setText($("position"), x === null ? "–" : `x ${x.toFixed(3)} m   y ${y.toFixed(3)} m`),
      onChoose: (vehicle) => !this.stopDrawing && vehicle && this.chooseVehicle(vehicle.id),
      onUserMove: () => this.setFollow(false),
      sayVehicle: ({ id, state }) => `${id}: ${STATES[state]?.word ?? state}`,
    });
    this.makeParts();
    this.listen();
    this.feed = new EventFeed({
      onOpen: () => this.resync(),
      onEvent: (name, data) => this.takeEvent(name, data),
      onAway: (error) => this.showAway(error),
    });
    setInterval(() => this.show(), LISTS_MS);
    setInterval(() => this.connected && this.resync().catch(() => {}), RESYNC_MS);
  }

  makeParts() {
    const chosenMap = () => this.view.map;
    this.maps = new MapList({ element: $("maps"), choice: $("map-choice") }, (map) => this.chooseMap(map));
    this.alerts = new AlertList($("alerts"), ({ vehicle, map }) => (vehicle ? this.chooseVehicle(vehicle.id) : this.chooseMap(map)));
    this.list = new VehicleList({ element: $("vehicles"), counts: $("state-counts") }, {
      choose: (id) => this.chooseVehicle(id),
      filterState: (state) => this.change({ state: this.view.state === state ? "" : state }),
    });
    this.panel = new VehiclePanel({
      onClose: () => this.closePanel(),
      onFollow: (on) => this.setFollow(on),
      onTrail: (on) => this.setTrail(on),
      onDraw: (on) => this.setDrawing(on),
      onInspect: () => this.inspect(this.chosen()),
      onPoseChange: () => this.floor.wake(),
    });
    this.fleet.onFix = (vehicle, fix) => this.panel.form.takeFix(vehicle, fix);
    this.versions = new MapVersions(chosenMap);
    this.tryIt = new TryIt(chosenMap, (source) => this.inspector.open(source));
    this.token = new TokenDialog(() => this.feed.reconnect());
    api.onUnauthorized.call = () => this.token.ask(this.connected
      ? "This server wants a token for that. Enter one, and try again."
      : "This server wants a token for reading. Enter one that its token file has.");
  }

  listen() {
    $("search").value = this.view.search;
    $("order").value = this.view.order;
    $("success").open = this.view.layer === "success";
    $("search").addEventListener("input", () => this.change({ search: $("search").value }));
    $("order").addEventListener("change", () => this.change({ order: $("order").value }));
    $("whole-floor").addEventListener("click", () => {
      this.setFollow(false);
      this.floor.fit();
    });
    document.addEventListener("keydown", (event) => this.onKey(event));
    initTheme();
  }

  onKey(event) {
    const typing = event.target.closest?.('input:not([type="radio"], [type="range"], [type="checkbox"]), select, textarea, dialog');
    if (event.key === "Escape" && !typing) {
      if (!this.inspector.close() && this.chosen()) {
        this.closePanel();
      }
    } else if (event.key === "/" && !typing) {
      event.preventDefault();
      $("search").focus();
    }
  }

  change(changes) {
    Object.assign(this.view, changes);
    writeView(this.view);
    this.show();
  }

  map(name = this.view.map) {
    return this.fleet.maps.find((map) => map.name === name);
  }

  chosen() {
    if (this.replay.drive) {
      return this.replay.drive;
    }
    const vehicle = this.fleet.vehicles.get(this.view.vehicle);
    return vehicle?.map === this.view.map ? vehicle : null;
  }

  /// Cached: it is asked for in every frame.
  vehiclesOnMap() {
    if (this.replay.drive) {
      return [this.replay.drive];
    }
    const { onMap, fleet, view } = this;
    if (onMap.revision !== fleet.revision || onMap.map !== view.map) {
      this.onMap = { map: view.map, revision: fleet.revision, vehicles: fleet.of(view.map) };
    }
    return this.onMap.vehicles;
  }

  // --- what the server says ---

  async resync() {
    const [maps, vehicles] = await Promise.all([api.listMaps(), api.listVehicles()]);
    this.fleet.setMaps(maps, now());
    this.fleet.setVehicles(vehicles, now());
    this.connected = true;
    setText($("connection"), "connected");
    $("connection").classList.remove("away");
    this.showMessage("");
    const known = maps.some(({ name }) => name === this.view.map);
    this.chooseMap(known ? this.view.map : this.mapOfChoice());
    this.show();
  }

  /// Where the URL's vehicle is, else the first map with vehicles.
  mapOfChoice() {
    const ranked = rankMaps(this.fleet).map(({ map }) => map);
    return this.fleet.vehicles.get(this.view.vehicle)?.map ?? (ranked.find(({ status }) => status === "ready") ?? ranked[0])?.name ?? "";
  }

  takeEvent(name, data) {
    if (this.fleet.apply(name, data, now())) {
      this.resyncTimer ??= setTimeout(() => {
        this.resyncTimer = null;
        this.resync().catch((error) => this.showAway(error));
        this.versions.refresh();
      }, 200);
    }
    if (data.map === this.view.map) {
      this.floor.wake();
    }
  }

  showAway(error) {
    this.connected = false;
    setText($("connection"), "not connected");
    $("connection").classList.add("away");
    this.showMessage(error instanceof api.ApiError ? error.message : "The connection to the server broke. Connecting again …");
  }

  showMessage(text) {
    setText($("message"), text);
    $("message").hidden = !text;
  }

  // --- what a person chooses ---

  chooseMap(name) {
    const map = this.map(name);
    const key = `${name} ${map?.version} ${map?.status}`;
    if (this.replay.drive) {
      this.replay.drive.map = name;
    }
    if (key !== this.shownMap) {
      this.shownMap = key;
      this.setDrawing(false);
      this.change({ map: name });
      this.showMap(map);
      this.versions.refresh();
    }
  }

  showMap(map) {
    this.replay.showFit(map);
    $("no-map").hidden = Boolean(map);
    $("map-error").hidden = map?.status !== "error";
    if (map?.status === "ready") {
      this.floor.show(map);
      api.listFixes(map.name).then((fixes) => this.fleet.addFixes(map.name, fixes, now())).catch(() => {});
    } else {
      this.floor.clear();
      setText($("map-error"), map ? `The map '${map.name}' cannot be shown: ${map.error}` : "");
    }
  }

  chooseVehicle(id) {
    const vehicle = this.fleet.vehicles.get(id);
    if (!vehicle) {
      return;
    }
    this.replay.close();
    this.chooseMap(vehicle.map);
    this.change({ vehicle: id });
    const place = vehicle.pose ?? vehicle.alternatives()[0];
    if (place && this.floor.leaflet) {
      this.floor.bringIntoView(place);
    }
    $("panel").scrollIntoView({ block: "nearest" });
  }

  closePanel() {
    if (this.replay.drive) {
      this.replay.close();
      return;
    }
    const id = this.view.vehicle;
    this.setFollow(false);
    this.change({ vehicle: "" });
    document.querySelector(`#vehicles li[data-key="${CSS.escape(id)}"] button`)?.focus({ preventScroll: true });
  }

  openDrive(drive) {
    drive.map = this.view.map;
    const first = drive.frames.find(({ fused }) => fused)?.fused;
    this.inspector.close();
    this.floor.element.classList.add("replaying");
    this.replay.showFit(this.map());
    if (first && this.floor.leaflet) {
      this.floor.bringIntoView(first);
    }
    this.show();
    $("panel").scrollIntoView({ block: "nearest" });
  }

  closeDrive() {
    this.setFollow(false);
    this.floor.element.classList.remove("replaying");
    this.show();
  }

  showReplay() {
    this.floor.wake();
    if (performance.now() - (this.panelShown ?? 0) > PANEL_MS) {
      this.panelShown = performance.now();
      this.showPanel();
    }
  }

  inspect({ id, map }) {
    this.inspector.open({ title: `Last image of ${id}`, map, vehicle: id, get: () => api.getLastFrame(id) });
  }

  setFollow(on) {
    this.follow = on && Boolean(this.chosen());
    this.panel.press("panel-follow", this.follow);
    this.floor.wake();
  }

  setTrail(on) {
    this.scene.showTrail = on;
    this.panel.press("panel-trail", on);
    this.floor.wake();
  }

  setDrawing(on) {
    this.stopDrawing?.();
    this.stopDrawing = on && this.floor.leaflet ? drawPoses(this.floor, (pose) => this.panel.form.draft(pose)) : null;
    if (on) {
      this.setFollow(false);
    }
  }

  followChosen() {
    const vehicle = this.follow && this.chosen();
    const place = { x: 0, y: 0, yaw: 0 };
    if (vehicle && vehicle.motion.at(now(), place)) {
      this.floor.goTo(place);
    }
  }

  // --- what is seen ---

  show() {
    const time = now();
    this.maps.show(this.fleet, this.view.map);
    this.alerts.show(this.fleet, time);
    this.list.show(this.fleet, this.view, time);
    this.tryIt.offer(this.vehiclesOnMap());
    this.showPanel();
    this.inspector.show(this.view.map, this.chosen());
    this.success.show(this.map());
    this.floor.redraw();
  }

  showPanel() {
    this.panel.open(this.chosen());
    this.panel.show(this.replay.drive?.time ?? now());
  }
}

globalThis.floorlocPage = new Page(); // for tests, and for whoever looks into it
