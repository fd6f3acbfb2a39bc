// SPDX-License-Identifier: Apache-2.0
// What the page knows of maps and vehicles: lists of the server, kept current by its events.
import { covarianceEllipse, distance } from "/web/data/geometry.js";
import { Motion } from "/web/data/motion.js";

const FIXES_KEPT = 50; // of each vehicle
const LOOSE_FIXES_KEPT = 60; // of each map, of images without a tracked vehicle

/// The fields of a fix record that the page shows; those of 2,000 vehicles are kept.
export function shorten({ sequence, received, status, reason, pose, fix, alternatives, accepted, reject_reason, reanchored }) {
  return {
    sequence, received, status, reason, accepted, reanchored, alternatives, rejectReason: reject_reason,
    pose: pose && { x: pose.x, y: pose.y, yaw: pose.yaw, covariance: pose.covariance },
    inliers: fix.inliers, matches: fix.matches, pWrong: fix.p_wrong, rms: fix.rms_m, warning: fix.warning,
  };
}

class Vehicle {
  constructor(id) {
    this.id = id;
    this.motion = new Motion();
    this.fixes = [];
    this.state = "";
    this.since = 0; // Unix time of the state
    this.sinceKnown = false; // false: it was so when the page came
    this.initialPose = null; // set by hand on this page: {pose, verdict, text, after, seen}
    this.path = 0; // metres, of all poses but the last, which may have jumped to an image
    this.lastStep = 0;
  }

  lastFix() {
    return this.fixes[this.fixes.length - 1];
  }

  /// Other places that explain the last image.
  alternatives() {
    return this.state === "ambiguous" ? this.listed ?? this.lastFix()?.alternatives ?? [] : [];
  }

  /// Takes pose, status and silence of a list entry or an event.
  update({ status, pose, epoch, silent_s: silent, alternatives }, now) {
    this.heard = now - (silent ?? 0);
    this.listed = alternatives?.length ? alternatives : undefined;
    this.status = status;
    if (pose) {
      this.path += this.lastStep;
      this.lastStep = this.pose && epoch === this.epoch ? distance(pose, this.pose) : 0;
      this.epoch = epoch;
      this.pose = pose;
      this.ellipse = covarianceEllipse(pose.covariance);
      this.motion.add(pose, epoch, now);
    }
    this.judge(now);
  }

  /// The server's status, but for lost vehicles: one whose last image shows several places is ambiguous, and one that has
  /// no pose, but images that were found, lets the server localize single images only.
  stateOf() {
    const last = this.lastFix()?.status;
    if (this.status !== "lost") {
      return this.status;
    }
    if (this.listed || last === "ambiguous") {
      return "ambiguous";
    }
    return !this.pose && last === "localized" ? "untracked" : "lost";
  }

  judge(now) {
    const state = this.stateOf();
    if (state !== this.state) {
      this.sinceKnown = this.state !== "";
      this.since = state === "stale" && !this.sinceKnown ? this.heard : now;
      this.sinceKnown ||= state === "stale";
      this.state = state;
    }
  }

  /// In the order of the images: a list of vehicles may tell the last one before the events tell those before it.
  addFix(fix) {
    const before = this.fixes.findLastIndex(({ sequence }) => sequence <= fix.sequence);
    if (this.fixes[before]?.sequence === fix.sequence) {
      return false;
    }
    this.fixes.splice(before + 1, 0, fix);
    if (this.fixes.length > FIXES_KEPT) {
      this.fixes.shift();
    }
    return true;
  }

  setOdometry(odometry, now) {
    if (odometry?.health !== this.odometry?.health) {
      this.odometrySince = { time: now, known: this.odometry !== undefined };
    }
    this.odometry = odometry;
  }
}

export class Fleet {
  constructor() {
    this.maps = [];
    this.vehicles = new Map();
    this.loose = new Map(); // map: fixes of images that no vehicle's pose tells of
    this.revision = 0; // grows with every change but poses
    this.onFix = () => {};
  }

  of(map) {
    return [...this.vehicles.values()].filter((vehicle) => vehicle.map === map);
  }

  setMaps(maps, now) {
    const before = new Map(this.maps.map((map) => [map.name, map]));
    this.maps = maps.map((map) => ({ ...map, since: before.get(map.name)?.since ?? now }));
    this.revision += 1;
  }

  setVehicles(list, now) {
    const ids = new Set(list.map(({ id }) => id));
    for (const id of this.vehicles.keys()) {
      if (!ids.has(id)) {
        this.vehicles.delete(id);
      }
    }
    for (const item of list) {
      const vehicle = this.vehicles.get(item.id) ?? this.create(item);
      vehicle.map = item.map;
      vehicle.setOdometry(item.odometry, now);
      this.setCamera(vehicle, item.camera_status, now);
      if (item.last_fix) {
        vehicle.addFix(shorten(item.last_fix));
      }
      this.update(vehicle, item, now);
    }
    this.revision += 1;
  }

  /// From its first pose on, a vehicle's fixes are its own.
  update(vehicle, data, now) {
    if (data.pose && !vehicle.pose) {
      this.loose.set(vehicle.map, (this.loose.get(vehicle.map) ?? []).filter((fix) => fix.vehicle !== vehicle.id));
    }
    vehicle.update(data, now);
  }

  setCamera(vehicle, status, now) {
    if (status !== vehicle.camera) {
      vehicle.cameraSince = { time: now, known: vehicle.camera !== undefined };
      vehicle.camera = status;
    }
  }

  /// Events tell of a vehicle's first images before a list tells of the vehicle: those are its own, too.
  create({ id, map }) {
    const vehicle = new Vehicle(id);
    this.vehicles.set(id, vehicle);
    (this.loose.get(map) ?? []).filter((fix) => fix.vehicle === id).forEach((fix) => vehicle.addFix(fix));
    return vehicle;
  }

  /// Adds fixes of a map that were made before the page came.
  addFixes(map, records, now) {
    records.forEach((record) => this.addFix({ ...record, map }, now));
  }

  addFix(record, now) {
    const vehicle = this.vehicles.get(record.vehicle);
    const fix = shorten(record);
    if (vehicle) {
      if (vehicle.addFix(fix)) {
        vehicle.judge(now);
        this.onFix(vehicle, fix);
      }
    }
    if (!vehicle?.pose) {
      this.addLoose(record.map, { ...fix, vehicle: record.vehicle });
    }
    this.revision += 1;
  }

  addLoose(map, fix) {
    const fixes = this.loose.get(map) ?? [];
    if (fixes.length === 0 || fix.sequence > fixes[fixes.length - 1].sequence) {
      this.loose.set(map, [...fixes, fix].slice(-LOOSE_FIXES_KEPT));
    }
  }

  /// Takes an event; returns whether the lists of the server must be asked for again.
  apply(name, data, now) {
    const vehicle = this.vehicles.get(data.vehicle);
    if (name === "fix") {
      this.addFix(data, now);
    } else if (name === "gap" || name === "map") {
      return true;
    } else if (name === "vehicle" && data.change === "removed") {
      this.vehicles.delete(data.vehicle);
      this.revision += 1;
    } else if (name === "vehicle" || (!vehicle && name !== "message")) {
      return true;
    } else if (name === "pose") {
      this.update(vehicle, data, now);
    } else if (name === "status") {
      vehicle.status = data.status;
      vehicle.heard = now - data.silent_s;
      vehicle.judge(now);
      this.revision += 1;
    } else if (name === "odometry") {
      vehicle.setOdometry(data, now);
      this.revision += 1;
    }
    return false;
  }

  /// Vehicles by state, over all maps or one.
  count(map) {
    const counts = {};
    for (const vehicle of this.vehicles.values()) {
      if (!map || vehicle.map === map) {
        counts[vehicle.state] = (counts[vehicle.state] ?? 0) + 1;
      }
    }
    return counts;
  }
}
