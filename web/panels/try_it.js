// SPDX-License-Identifier: Apache-2.0
// Localizes an image by hand.
import * as api from "/web/data/api.js";
import { $, h, setText, syncList } from "/web/dom.js";

const IDS_OFFERED = 200;

export class TryIt {
  /// chosenMap(): name of the map that is shown; onAnswer({title, map, vehicle, get()}): see Inspector.open.
  constructor(chosenMap, onAnswer) {
    this.onAnswer = onAnswer;
    this.chosenMap = chosenMap;
    this.file = null;
    $("image").addEventListener("change", (event) => this.select(event.target.files[0]));
    $("localize").addEventListener("click", () => this.localize());
    for (const type of ["dragover", "dragleave", "drop"]) {
      $("drop").addEventListener(type, (event) => {
        event.preventDefault();
        $("drop").classList.toggle("over", type === "dragover");
        if (type === "drop") {
          this.select(event.dataTransfer.files[0]);
        }
      });
    }
  }

  offer(vehicles) {
    syncList($("vehicle-ids"), vehicles.slice(0, IDS_OFFERED), {
      key: ({ id }) => id,
      create: ({ id }) => h("option", { value: id }),
      update: () => {},
    });
  }

  select(file) {
    this.file = file ?? null;
    setText($("image-name"), file ? file.name : "Drop a camera image here, or choose one");
  }

  async localize() {
    const vehicle = $("vehicle").value.trim();
    const map = this.chosenMap();
    if (!map || !this.file || !vehicle) {
      setText($("answer"), "Choose a map, an image and a registered vehicle first.");
      return;
    }
    $("localize").disabled = true;
    try {
      const { inspection, ...fix } = await api.localize(map, vehicle, this.file);
      setText($("answer"), JSON.stringify(fix, null, 1));
      this.onAnswer({ title: this.file.name, map, vehicle: null, get: async () => ({ fix, inspection }) });
    } catch (error) {
      setText($("answer"), `${error.message} (${error.code})`);
    }
    $("localize").disabled = false;
  }
}
