// SPDX-License-Identifier: Apache-2.0
// The list of vehicles: search, sort, and counts by state that filter it.
import { h, setText, syncList } from "/web/dom.js";
import { STATES, sayDuration } from "/web/words.js";

const ROWS_SHOWN = 150;
const URGENCY = Object.keys(STATES);

const byId = (a, b) => a.id.localeCompare(b.id, "en", { numeric: true });
const ORDERS = {
  state: (a, b) => URGENCY.indexOf(a.state) - URGENCY.indexOf(b.state) || a.since - b.since || byId(a, b),
  name: byId,
  heard: (a, b) => a.heard - b.heard || byId(a, b),
};

/// The vehicles to list. filter: {search, order, state, map}; a search looks on all maps.
export function selectVehicles(fleet, { search, order, state, map }) {
  const wanted = search.trim().toLowerCase();
  return [...fleet.vehicles.values()]
    .filter((vehicle) => (wanted ? vehicle.id.toLowerCase().includes(wanted) : !map || vehicle.map === map))
    .filter((vehicle) => !state || vehicle.state === state)
    .sort(ORDERS[order] ?? ORDERS.state);
}

export class VehicleList {
  constructor({ element, counts }, { choose, filterState }) {
    this.list = element.querySelector("ul");
    this.note = element.querySelector(".note");
    this.empty = element.querySelector(".empty");
    this.choose = choose;
    this.buttons = Object.entries(STATES).map(([state, { word, sign }]) => {
      const number = h("b");
      const button = h("button", { type: "button", class: `chip ${state}`, "aria-pressed": "false", onclick: () => filterState(state) },
        h("span", { class: "sign", "aria-hidden": "true" }, sign), number, ` ${word}`);
      return { state, number, button };
    });
    counts.replaceChildren(...this.buttons.map(({ button }) => h("li", {}, button)));
  }

  /// view: {search, order, state, map, vehicle}
  show(fleet, view, now) {
    const counts = fleet.count();
    for (const { state, number, button } of this.buttons) {
      setText(number, String(counts[state] ?? 0));
      button.setAttribute("aria-pressed", String(view.state === state));
      button.classList.toggle("none", !counts[state]);
      button.parentElement.hidden = state === "untracked" && !counts[state];
    }
    const vehicles = selectVehicles(fleet, view);
    syncList(this.list, vehicles.slice(0, ROWS_SHOWN), {
      key: ({ id }) => id,
      create: () => this.createRow(),
      update: (row, vehicle) => this.updateRow(row, vehicle, view, now),
    });
    this.empty.hidden = fleet.vehicles.size > 0;
    setText(this.note, this.say(fleet, vehicles.length, view));
  }

  say(fleet, found, { search, state, map }) {
    if (fleet.vehicles.size === 0) {
      return "";
    }
    const kind = state ? `${STATES[state].word} vehicle` : "vehicle";
    if (found === 0) {
      return search ? `No ${kind} has "${search}" in its name.` : `No ${kind} on ${map || "any map"}.`;
    }
    const rest = found > ROWS_SHOWN ? `; the first ${ROWS_SHOWN} are listed, search for others` : "";
    return `${found} of ${fleet.vehicles.size}${rest}`;
  }

  createRow() {
    const [sign, name, text, when] = ["sign", "name", "text", "when"].map((name) => h("span", { class: name }));
    const button = h("button", { type: "button", class: "row", onclick: () => this.choose(row.dataset.key) }, sign, name, text, when);
    const row = h("li", {}, button);
    return Object.assign(row, { button, parts: { sign, name, text, when } });
  }

  updateRow(row, vehicle, view, now) {
    const { sign, word } = STATES[vehicle.state] ?? STATES.lost;
    row.className = vehicle.state;
    row.button.setAttribute("aria-current", String(vehicle.id === view.vehicle));
    setText(row.parts.sign, sign);
    setText(row.parts.name, vehicle.id);
    setText(row.parts.text, vehicle.map === view.map ? word : `${word}, on ${vehicle.map}`);
    setText(row.parts.when, vehicle.fixes.length || vehicle.pose ? `${sayDuration(now - vehicle.heard)} ago` : "no image yet");
  }
}
