// SPDX-License-Identifier: Apache-2.0
// Localizes an image by hand.
import * as api from "/web/data/api.js";
import { $, acceptFile, h, setText, syncList } from "/web/dom.js";

const IDS_OFFERED = 200;

export class TryIt {
  /// chosenMap(): name of the map that is shown; onAnswer({title, map, vehicle, get()}): see Inspector.open.
  constructor(chosenMap, onAnswer) {
    this.onAnswer = onAnswer;
    this.chosenMap = chosenMap;
    this.file = null;
    acceptFile($("drop"), (file) => this.select(file));
    $("localize").addEventListener("click", () => this.localize());
  }

  offer(vehicles) {
    syncList($("vehicle-ids"), vehicles.slice(0, IDS_OFFERED), {
      key: ({ id }) => id,
      create: ({ id }) => h("option", { value: id }),
      update: () => {},
    });
  }

  select(file) {
    this.file = file;
    setText($("image-name"), file.name);
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
