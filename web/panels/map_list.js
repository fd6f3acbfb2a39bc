// SPDX-License-Identifier: Apache-2.0
// All maps with their vehicles by state, those with vehicles first.
import { h, setText, syncList } from "/web/dom.js";
import { STATES } from "/web/words.js";

const sum = (counts) => Object.values(counts).reduce((a, b) => a + b, 0);

/// Maps with their counts of vehicles: those with vehicles first, then by name.
export function rankMaps(fleet) {
  return fleet.maps
    .map((map) => ({ map, counts: fleet.count(map.name) }))
    .map((entry) => ({ ...entry, vehicles: sum(entry.counts) }))
    .sort((a, b) => Math.sign(b.vehicles) - Math.sign(a.vehicles) || a.map.name.localeCompare(b.map.name));
}

function sayFacts({ status, area_m2: area, layers }) {
  if (status !== "ready") {
    return "";
  }
  const keypoints = layers.reduce((total, layer) => total + layer.keypoints, 0);
  return `${area.toFixed(1)} m², ${keypoints.toLocaleString("en")} keypoints`;
}

export class MapList {
  constructor({ element, choice }, choose) {
    this.list = element.querySelector("ul");
    this.empty = element.querySelector(".empty");
    this.choice = choice;
    this.choose = choose;
    choice.addEventListener("change", () => choose(choice.value));
  }

  show(fleet, chosen) {
    const entries = rankMaps(fleet);
    this.empty.hidden = entries.length > 0;
    syncList(this.choice, entries, {
      key: ({ map }) => map.name,
      create: ({ map }) => new Option("", map.name),
      update: (option, { map, vehicles }) =>
        setText(option, map.status === "ready" ? `${map.name} (${vehicles})` : `${map.name} (damaged)`),
    });
    if (this.choice.value !== chosen) {
      this.choice.value = chosen;
    }
    syncList(this.list, entries, {
      key: ({ map }) => map.name,
      create: () => this.createRow(),
      update: (row, entry) => this.updateRow(row, entry, chosen),
    });
  }

  createRow() {
    const [name, facts, counts] = ["name", "facts", "counts"].map((name) => h("span", { class: name }));
    const button = h("button", { type: "button", class: "row", onclick: () => this.choose(row.dataset.key) }, name, counts, facts);
    const row = h("li", {}, button);
    return Object.assign(row, { button, parts: { name, facts, counts } });
  }

  updateRow(row, { map, counts, vehicles }, chosen) {
    row.classList.toggle("damaged", map.status !== "ready");
    row.button.setAttribute("aria-current", String(map.name === chosen));
    setText(row.parts.name, map.name);
    setText(row.parts.facts, sayFacts(map));
    const states = Object.entries(STATES).filter(([state]) => counts[state]);
    syncList(row.parts.counts, states, {
      key: ([state]) => state,
      create: ([state]) => h("span", { class: `chip ${state}`, role: "img" }),
      update: (chip, [state, { word, sign }]) => {
        chip.setAttribute("title", word);
        chip.setAttribute("aria-label", `${counts[state]} ${word}`);
        setText(chip, `${sign} ${counts[state]}`);
      },
    });
    if (vehicles === 0 && !row.parts.counts.firstChild) {
      row.parts.counts.append(h("span", { class: "soft" }, "no vehicles"));
    }
  }
}
