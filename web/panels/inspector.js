// SPDX-License-Identifier: Apache-2.0
// The look into a fix: an image over the floor, at the pose that was found and at its rivals.
import { shorten } from "/web/data/fleet.js";
import { distance, wrapAngle } from "/web/data/geometry.js";
import { $, h, setText } from "/web/dom.js";
import { degrees, sayClock, sayLength, sayOutcome, sayProbability } from "/web/words.js";

const decode = async (base64) => {
  const image = new Image();
  image.src = `data:image/png;base64,${base64}`;
  await image.decode();
  return image;
};

/// How many such poses chance would make.
const sayChance = (log10) => (log10 < -6 ? "none" : sayProbability(10 ** log10));

export class Inspector {
  /// handlers: onChange(), it is to be drawn; onLook(inspection, pose), the floor is to show it there.
  constructor(handlers) {
    this.handlers = handlers;
    this.shown = null;
    $("inspector-close").addEventListener("click", () => this.close());
    $("inspector-newest").addEventListener("click", () => this.ask());
    $("inspector-blend").addEventListener("input", handlers.onChange);
    $("inspector-matches").addEventListener("change", handlers.onChange);
    $("inspector-poses").addEventListener("change", (event) => this.choose(Number(event.target.value)));
  }

  /// source: {title, map, vehicle: whose panel it belongs to, or null, get(): {fix, inspection}}
  async open(source) {
    this.source = source;
    this.shown = null;
    $("inspector").hidden = false;
    setText($("inspector-title"), source.title);
    await this.ask();
    $("inspector").scrollIntoView({ block: "nearest" });
    $("inspector-title").focus({ preventScroll: true });
  }

  async ask() {
    const { source } = this;
    this.say("The server localizes the image once more …");
    try {
      const { fix, inspection } = await source.get();
      const image = await decode(inspection.image);
      if (source === this.source) {
        this.take({ ...inspection, image, fix: shorten(fix) });
      }
    } catch (error) {
      if (source === this.source) {
        this.shown = null;
        this.say(error.message, true);
      }
    }
    this.handlers.onChange();
  }

  say(text, failed = false) {
    setText($("inspector-said"), text);
    $("inspector-said").classList.toggle("failed", failed);
    $("inspector-tools").hidden = !this.shown;
  }

  take(inspection) {
    this.shown = inspection;
    const { fix, poses } = inspection;
    this.found = poses.length > 0 && fix.pose && distance(poses[0], fix.pose) < 1e-6;
    this.say(`${fix.received ? `${sayClock(fix.received)}: ` : ""}${sayOutcome(fix)}`);
    $("inspector-poses").replaceChildren(h("legend", {}, poses.length > 0 ? "Drawn at" : "It matches nowhere"),
      ...poses.map((pose, i) => h("label", { class: "check" },
        h("input", { type: "radio", name: "inspected-pose", value: i }), h("span", {}, this.sayPose(pose, i)))));
    if (poses.length > 0) {
      $("inspector-poses").querySelector("input").checked = true;
      this.choose(0);
    }
  }

  sayPose(pose, i) {
    const { poses } = this.shown;
    const [first] = poses;
    const turn = Math.abs(degrees(wrapAngle(pose.yaw - first.yaw))).toFixed(0);
    const place = i === 0 ? (this.found ? "the pose that was found" : "the best pose, which is not accepted")
      : `${sayLength(distance(pose, first))} and ${turn}° from there`;
    return `${place}: ${pose.inliers} of ${pose.matches.length} matches agree, poses like that by chance: ${sayChance(pose.log10_nfa)}`;
  }

  choose(i) {
    this.chosen = i;
    this.handlers.onLook(this.shown, this.shown.poses[i]);
    this.handlers.onChange();
  }

  /// What is to be drawn, or null.
  scene() {
    const { shown } = this;
    const pose = shown?.poses[this.chosen];
    return pose ? { ...shown, pose, rival: this.chosen > 0 || !this.found, showMatches: $("inspector-matches").checked,
      blend: Number($("inspector-blend").value) / 100 } : null;
  }

  /// Closes what is of another map or vehicle than those that are shown, and tells of a newer image.
  show(map, vehicle) {
    const { source } = this;
    if (source && (source.map !== map || (source.vehicle && source.vehicle !== vehicle?.id))) {
      this.close();
    }
    $("inspector-newest").hidden = !source?.vehicle || !((vehicle?.lastFix()?.sequence ?? 0) > (this.shown?.fix.sequence ?? 0));
  }

  close() {
    const open = Boolean(this.source);
    this.source = null;
    this.shown = null;
    $("inspector").hidden = true;
    this.handlers.onChange();
    return open;
  }
}
