// SPDX-License-Identifier: Apache-2.0
// What an operator has to look at, the worst first and of equals the longest.
import { h, setText, syncList } from "/web/dom.js";
import { STATES, sayClock, sayDuration } from "/web/words.js";

const ROWS_SHOWN = 60;

const SEVERITIES = { 3: "urgent", 2: "soon", 1: "note" };

/// since: Unix time; known: false when it was so before the page came.
function stateAlert(vehicle) {
  const { state, since, sinceKnown } = vehicle;
  const base = { key: `${vehicle.id} state`, vehicle, since, known: sinceKnown };
  if (state === "lost") {
    return vehicle.pose ? { ...base, severity: 3, sign: STATES.lost.sign, text: "lost" }
      : { ...base, severity: 2, sign: STATES.lost.sign, text: "never found yet" };
  }
  if (state === "ambiguous") {
    return { ...base, severity: 2, sign: STATES.ambiguous.sign, text: "may be at several places" };
  }
  return state === "stale" ? { ...base, severity: 2, sign: STATES.stale.sign, text: "silent" } : null;
}

function odometryAlert(vehicle) {
  const { health, cure } = vehicle.odometry ?? {};
  const base = { key: `${vehicle.id} odometry`, vehicle, since: vehicle.odometrySince?.time, known: vehicle.odometrySince?.known };
  if (health === "rejected") {
    return { ...base, severity: 3, sign: "↯", text: "odometry rejected", cure };
  }
  return health === "suspect" ? { ...base, severity: 1, sign: "↯", text: "odometry suspect: the last images contradict it" } : null;
}

function cameraAlert(vehicle) {
  if (vehicle.camera !== "implausible") {
    return null;
  }
  return {
    key: `${vehicle.id} camera`, vehicle, severity: 2, sign: "◎", text: "calibration off",
    cure: "Calibrate its camera, or mount it, anew.", since: vehicle.cameraSince.time, known: vehicle.cameraSince.known,
  };
}

function mapAlert(map) {
  const base = { key: `map ${map.name}`, map: map.name, since: map.since, known: false, sign: "▧" };
  if (map.status === "error") {
    return { ...base, severity: 3, text: "map damaged", cure: map.error };
  }
  return map.refused_file ? { ...base, severity: 1, text: "its new file is not served", cure: map.refused_file.error } : null;
}

export function listAlerts(fleet) {
  const alerts = fleet.maps.map(mapAlert);
  for (const vehicle of fleet.vehicles.values()) {
    alerts.push(stateAlert(vehicle), odometryAlert(vehicle), cameraAlert(vehicle));
  }
  return alerts.filter(Boolean).sort((a, b) =>
    b.severity - a.severity || a.since - b.since || a.key.localeCompare(b.key, "en", { numeric: true }));
}

function saySince({ since, known }, now) {
  return known ? `since ${sayClock(since)} (${sayDuration(now - since)})` : `since before ${sayClock(since)}`;
}

export class AlertList {
  /// choose(alert): someone wants to see it.
  constructor(element, choose) {
    this.element = element;
    this.choose = choose;
    this.list = element.querySelector("ul");
    this.note = element.querySelector(".note");
    this.count = element.querySelector(".count");
  }

  show(fleet, now) {
    const alerts = listAlerts(fleet);
    setText(this.count, alerts.length ? String(alerts.length) : "");
    syncList(this.list, alerts.slice(0, ROWS_SHOWN), {
      key: (alert) => alert.key,
      create: () => this.createRow(),
      update: (row, alert) => this.updateRow(row, alert, now),
    });
    const more = alerts.length - ROWS_SHOWN;
    const none = fleet.vehicles.size > 0 ? "Nothing to look at: every vehicle knows where it is." : "No alerts.";
    setText(this.note, more > 0 ? `and ${more} more` : alerts.length === 0 ? none : "");
  }

  createRow() {
    const [sign, name, text, since, cure] = ["sign", "name", "text", "since", "cure"].map((name) =>
      h("span", { class: name, "aria-hidden": name === "sign" && "true" }));
    const choose = () => this.choose(row.alert);
    const row = h("li", {}, h("button", { type: "button", class: "row", onclick: choose }, sign, name, text, since, cure));
    return Object.assign(row, { parts: { sign, name, text, since, cure } });
  }

  updateRow(row, alert, now) {
    row.alert = alert;
    row.className = SEVERITIES[alert.severity];
    setText(row.parts.sign, alert.sign);
    setText(row.parts.name, alert.vehicle?.id ?? alert.map);
    setText(row.parts.text, alert.text);
    setText(row.parts.since, saySince(alert, now));
    setText(row.parts.cure, alert.cure ?? "");
  }
}
