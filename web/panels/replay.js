// SPDX-License-Identifier: Apache-2.0
// Replays a recorded drive on the floor: time slider, play at several speeds.
import { Drive } from "/web/data/drive.js";
import { $, acceptFile, setText } from "/web/dom.js";
import { STATES, sayClock } from "/web/words.js";

const LONGEST_STEP_S = 0.25; // of real time, when the page was in the background

export class Replay {
  /// handlers: onOpen(drive), onTime(): the vehicle is elsewhere, onClose().
  constructor(handlers) {
    this.handlers = handlers;
    this.drive = null;
    this.playing = false;
    acceptFile($("replay-drop"), (file) => this.open(file));
    $("replay-play").addEventListener("click", () => this.play(!this.playing));
    $("replay-close").addEventListener("click", () => this.close());
    $("replay-time").addEventListener("input", () => this.seek(this.drive.start + Number($("replay-time").value)));
  }

  async open(file) {
    setText($("replay-said"), `Reading ${file.name} …`);
    try {
      const drive = await Drive.read(file);
      this.drive = drive;
      $("replay").hidden = false;
      $("replay-time").max = drive.end - drive.start;
      setText($("replay-said"), "");
      this.handlers.onOpen(drive);
      this.seek(drive.start);
      this.play(true);
      $("replay-play").focus();
    } catch (error) {
      setText($("replay-said"), error.message);
    }
  }

  /// Warns of a drive that is not on the map that is shown.
  showFit(map) {
    const strange = this.drive && map?.extent && this.drive.shareWithin(map.extent) < 0.5;
    setText($("replay-said"), strange ? `Most of ${this.drive.id} is outside of ${map.name}: was it localized in another map? Choose that one.` : "");
  }

  play(on) {
    const { drive } = this;
    this.playing = on && Boolean(drive);
    if (this.playing && drive.time >= drive.end) {
      this.seek(drive.start);
    }
    this.last = performance.now();
    setText($("replay-play"), this.playing ? "❚❚ Pause" : "▶ Play");
    this.handlers.onTime();
  }

  seek(time) {
    const { drive } = this;
    drive.seek(time);
    const seconds = drive.time - drive.start;
    $("replay-time").value = seconds;
    const clock = `${seconds.toFixed(1)} s of ${(drive.end - drive.start).toFixed(1)} s, ${sayClock(drive.time)}`;
    setText($("replay-clock"), clock);
    $("replay-time").setAttribute("aria-valuetext", `${clock}, ${STATES[drive.state].word}`);
    this.handlers.onTime();
  }

  /// Goes on by the time since the last call.
  tick() {
    if (this.playing) {
      const now = performance.now();
      const step = Math.min(LONGEST_STEP_S, (now - this.last) / 1000);
      this.last = now;
      this.seek(this.drive.time + step * Number($("replay-speed").value));
      if (this.drive.time >= this.drive.end) {
        this.play(false);
      }
    }
  }

  close() {
    if (this.drive) {
      this.play(false);
      this.drive = null;
      $("replay").hidden = true;
      setText($("replay-said"), "");
      this.handlers.onClose();
    }
  }
}
