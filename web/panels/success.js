// SPDX-License-Identifier: Apache-2.0
// Where images are found on the map that is shown: the layer while its part is open, and where to survey again.
import * as api from "/web/data/api.js";
import { $, h, setText, syncList } from "/web/dom.js";
import { shareOf } from "/web/floor/success_layer.js";
import { sayDate } from "/web/words.js";

const REFRESH_MS = 10000;
const PLACES = 10;
// What a square of the map is worth, as its report has it (docs/survey.md, "Weak floor is computed").
const NEEDED_IN_VIEW = 100;
const DUPLICATE_BELOW = 0.1;

/// True where a camera's view, m2, would hold too few usable keypoints.
function isWeak({ keypoints, observations, distinctiveness }, cellM, viewM2) {
  const usable = keypoints * (observations < 1.5 ? 0.5 : 1) * (distinctiveness < DUPLICATE_BELOW ? 0.2 : 1);
  return (usable * viewM2) / cellM ** 2 < NEEDED_IN_VIEW;
}

async function weakSquares(map) {
  const [{ cells, cell_m: weakSide }, { floor }] = await Promise.all([api.getQuality(map), api.getMap(map)]);
  const { x_min: left, x_max: right, y_min: low, y_max: high } = floor.roi;
  return { weakSide, weak: cells.filter((cell) => isWeak(cell, weakSide, (right - left) * (high - low))) };
}

export class Success {
  /// handlers: onChange(), it is to be drawn anew; onLook(points), the floor is to show them; onToggle(open).
  constructor(handlers) {
    this.handlers = handlers;
    $("success").addEventListener("toggle", () => {
      this.asked = 0;
      handlers.onToggle($("success").open);
    });
  }

  /// map: as the server lists it, or undefined.
  async show(map) {
    const key = map?.status === "ready" && $("success").open ? `${map.name} ${map.version}` : null;
    const time = performance.now();
    if (key !== this.key) {
      Object.assign(this, { key, squares: null, weak: null, asked: 0 });
      this.handlers.onChange();
    }
    if (!key || (this.asked && time - this.asked < REFRESH_MS)) {
      return;
    }
    this.asked = time;
    try {
      const [squares, weak] = await Promise.all([api.getSuccess(map.name), this.weak ?? weakSquares(map.name)]);
      if (key === this.key) {
        Object.assign(this, { squares, weak });
        this.say(squares);
        this.handlers.onChange();
      }
    } catch (error) {
      setText($("success-said"), error.message);
    }
  }

  say({ cells, since, unplaced, cell_m: side }) {
    const sum = (key) => cells.reduce((total, cell) => total + cell[key], 0);
    const [found, missed] = [sum("found"), sum("missed")];
    setText($("success-said"), since ? `Of the last ${(found + missed).toLocaleString("en")} images since ${sayDate(since)}, `
      + `${found.toLocaleString("en")} were found.${unplaced ? ` ${unplaced.toLocaleString("en")} more were missed, nobody knows where.` : ""}`
      : "No vehicle has sent an image in this map yet.");
    const places = cells.filter((cell) => cell.survey_again).sort((a, b) => b.missed - a.missed).slice(0, PLACES);
    $("success-nowhere").hidden = places.length > 0;
    syncList($("success-places"), places, {
      key: ({ x, y }) => `${x} ${y}`,
      create: ({ x, y }) => h("li", { class: "lost" }, h("button", { type: "button", class: "row",
        onclick: () => this.handlers.onLook([{ x: x - side, y: y - side }, { x: x + 2 * side, y: y + 2 * side }]) },
      h("span", { class: "sign", "aria-hidden": "true" }, "✕"), h("span"))),
      update: (row, cell) => setText(row.querySelector("span:last-child"), `${(cell.x + side / 2).toFixed(2)}, `
        + `${(cell.y + side / 2).toFixed(2)} m: ${cell.found} of ${cell.found + cell.missed} found (${(100 * shareOf(cell)).toFixed(0)} %)`),
    });
  }

  /// What is to be drawn, or null.
  scene() {
    return this.squares && { cells: this.squares.cells, side: this.squares.cell_m, ...this.weak };
  }
}
