// SPDX-License-Identifier: Apache-2.0
// The versions of the map that is shown: list, activate, roll back, delete, upload.
import * as api from "/web/data/api.js";
import { $, h, setText } from "/web/dom.js";
import { sayClock, sayDuration } from "/web/words.js";

const ORIGINS = { upload: "uploaded", folder: "from the maps folder", recovered: "found again after a crash" };

const short = (version) => version.slice(0, 8);
const sayBytes = (bytes) => (bytes < 1e6 ? `${(bytes / 1e3).toFixed(0)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);
const sayVehicles = ({ kept, lost }) =>
  `${kept} vehicles keep their pose${lost ? `, ${lost} are lost until their next image, as the frame is another one` : ""}.`;

function sayDifference(version, other) {
  const area = version.area_m2 - other.area_m2;
  const parts = [version.id === other.id ? "same frame" : "another frame: vehicles will be lost until their next image"];
  if (Math.abs(area) >= 0.05) {
    parts.push(`${Math.abs(area).toFixed(1)} m² ${area > 0 ? "more" : "less"}`);
  }
  return `${parts.join(", ")} than the one that is served`.replace("same frame than", "same frame as");
}

export class MapVersions {
  /// chosenMap(): name of the map that is shown.
  constructor(chosenMap) {
    this.chosenMap = chosenMap;
    $("versions").addEventListener("toggle", () => this.refresh());
    $("upload-file").addEventListener("change", () => this.showFile());
    $("upload-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.upload();
    });
    $("roll-back").addEventListener("click", () => this.activate("previous"));
  }

  say(text, failed = false) {
    setText($("versions-said"), text);
    $("versions-said").classList.toggle("failed", failed);
  }

  /// Of another map, or after a change that an event told.
  async refresh() {
    const map = this.chosenMap();
    if (!$("versions").open || !map) {
      return;
    }
    try {
      const list = await api.listVersions(map);
      if (map === this.chosenMap()) {
        this.show(list);
      }
    } catch (error) {
      this.say(error.message, true);
    }
  }

  show({ active, previous, versions }) {
    const served = versions.find(({ version }) => version === active);
    $("roll-back").disabled = !previous;
    setText($("roll-back"), previous ? `Roll back to ${short(previous)}` : "No version to roll back to");
    setText($("versions-title"), `Versions of ${this.chosenMap()}`);
    $("version-list").replaceChildren(...versions.map((version) => this.row(version, served)));
  }

  row(version, served) {
    const ago = `${sayDuration(Date.now() / 1000 - version.added)} ago, ${sayClock(version.added)}`;
    const origin = ORIGINS[version.origin] ?? version.origin;
    const facts = h("span", { class: "facts" }, `${version.area_m2.toFixed(1)} m², ${sayBytes(version.bytes)}; ${origin} ${ago}`,
      !version.active && served && h("span", { class: "difference" }, sayDifference(version, served)));
    const name = short(version.version);
    const button = (verb, kind, onclick) =>
      h("button", { type: "button", class: kind, "aria-label": `${verb} version ${name}`, onclick }, verb);
    const actions = version.active ? h("b", { class: "served" }, "● served")
      : h("span", { class: "actions" },
        button("Activate", "", () => this.activate(version.version)),
        button("Delete", "quiet", () => this.remove(version.version)));
    return h("li", {}, h("code", { title: version.version }, name), actions, facts);
  }

  async act(what, change) {
    this.say(`${what} …`);
    try {
      this.say(await change());
    } catch (error) {
      this.say(error.message, true);
    }
    await this.refresh();
  }

  activate(version) {
    return this.act("Activating", async () => {
      const answer = await api.activateVersion(this.chosenMap(), version);
      return `Version ${short(answer.version)} is served. ${sayVehicles(answer.vehicles)}`;
    });
  }

  remove(version) {
    return this.act("Deleting", async () => {
      await api.deleteVersion(this.chosenMap(), version);
      return `Version ${short(version)} is deleted.`;
    });
  }

  showFile() {
    const file = $("upload-file").files[0];
    if (file && !$("upload-name").value) {
      $("upload-name").value = file.name.replace(/\.floormap$/, "").replace(/[^A-Za-z0-9_-]/g, "_").slice(0, 64);
    }
  }

  upload() {
    const file = $("upload-file").files[0];
    const map = $("upload-name").value.trim() || this.chosenMap();
    if (!file || !map) {
      this.say("Choose a map file (NAME.floormap) and the name of its map first.", true);
      return;
    }
    const bar = $("upload-progress");
    bar.hidden = false;
    bar.value = 0;
    $("upload-send").disabled = true;
    this.act("Uploading", async () => {
      const version = await api.uploadVersion(map, file, $("upload-activate").checked, (share) => {
        bar.value = share;
        this.say(share < 1 ? `Uploading: ${Math.floor(100 * share)} %` : "Sent. The server verifies it …");
      });
      return `Version ${short(version.version)} of ${map} is ${version.active ? "served" : "kept, and waits for its activation"}.`;
    }).finally(() => {
      bar.hidden = true;
      $("upload-send").disabled = false;
    });
  }
}
