// SPDX-License-Identifier: Apache-2.0
// A pose set by hand: drawn on the floor or typed; the next image confirms or contradicts it.
import * as api from "/web/data/api.js";
import { distance, wrapAngle } from "/web/data/geometry.js";
import { $, setText } from "/web/dom.js";
import { degrees, radians, sayLength, sayOutcome } from "/web/words.js";

const NEAR_M = 0.3; // three standard deviations of a pose set by hand, as the server takes it
const NEAR_RAD = 0.3;
const SHORTEST_DRAG_PX = 12;

function difference(a, b) {
  const turn = wrapAngle(a.yaw - b.yaw);
  const metres = distance(a, b);
  return { metres, turn: Math.abs(turn), text: `${sayLength(metres)}, ${Math.abs(degrees(turn)).toFixed(1)}°` };
}

/// What a fix says of a pose set by hand. path: how far the vehicle drove since (m).
export function judgePose(pose, fix, path) {
  if (fix.status !== "localized") {
    return { verdict: "waiting", text: `The last image could not tell (${sayOutcome(fix)}). Waiting for the next one.` };
  }
  const { metres, turn, text } = difference(fix.pose, pose);
  const near = metres < NEAR_M + path && (turn < NEAR_RAD || path > 0.1);
  const agrees = near && fix.accepted !== false;
  return agrees
    ? { verdict: "confirmed", text: `✓ Confirmed by the next image, ${text} from what you set.`, seen: fix.pose }
    : { verdict: "contradicted", text: `✕ Contradicted: the image is ${text} from what you set. Was it that place?`, seen: fix.pose };
}

export class InitialPoseForm {
  /// handlers: onDraw(on), a person wants to draw or not; onPoseChange(), it is to be drawn.
  constructor(handlers) {
    this.handlers = handlers;
    this.fields = { x: $("pose-x"), y: $("pose-y"), yaw: $("pose-yaw") };
    $("panel-set-pose").addEventListener("click", () => this.begin());
    $("pose-cancel").addEventListener("click", () => this.end());
    $("pose-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.send();
    });
    $("pose-form").addEventListener("input", () => this.readFields());
    $("pose-form").addEventListener("keydown", (event) => {
      if (event.key === "Escape") {
        this.end();
        event.stopPropagation();
      }
    });
  }

  open(vehicle) {
    this.end();
    this.vehicle = vehicle;
  }

  begin() {
    $("pose-form").hidden = false;
    const { pose } = this.vehicle;
    this.draft(pose ? { x: pose.x, y: pose.y, yaw: pose.yaw } : null);
    this.handlers.onDraw(true);
    this.fields.x.focus();
  }

  end() {
    $("pose-form").hidden = true;
    setText($("pose-error"), "");
    this.handlers.onDraw(false);
    if (this.vehicle?.initialPose?.verdict === "draft") {
      this.vehicle.initialPose = null;
    }
    this.handlers.onPoseChange();
  }

  /// Takes a pose that was drawn (or nothing, before that).
  draft(pose) {
    this.vehicle.initialPose = pose && { pose, verdict: "draft", text: "" };
    if (pose) {
      this.fields.x.value = pose.x.toFixed(3);
      this.fields.y.value = pose.y.toFixed(3);
      this.fields.yaw.value = degrees(pose.yaw).toFixed(1);
    }
    this.handlers.onPoseChange();
  }

  readFields() {
    const [x, y, yaw] = Object.values(this.fields).map((field) => (field.value === "" ? NaN : Number(field.value)));
    const pose = [x, y, yaw].every(Number.isFinite) ? { x, y, yaw: radians(yaw) } : null;
    this.vehicle.initialPose = pose && { pose, verdict: "draft", text: "" };
    this.handlers.onPoseChange();
    return pose;
  }

  async send() {
    const { vehicle } = this;
    const pose = this.readFields();
    if (!pose) {
      setText($("pose-error"), "Draw an arrow on the floor, or give x, y and heading.");
      return;
    }
    try {
      await api.setPose(vehicle.id, pose);
      vehicle.initialPose = {
        pose, verdict: "waiting", text: "Set. Waiting for the next image.",
        after: vehicle.lastFix()?.sequence ?? 0, path: vehicle.path + vehicle.lastStep,
      };
      this.end();
    } catch (error) {
      setText($("pose-error"), error.message);
    }
  }

  /// Takes a fix that came; the first that can tell decides.
  takeFix(vehicle, fix) {
    const set = vehicle.initialPose;
    if (set?.verdict === "waiting" && fix.sequence > set.after) {
      Object.assign(set, judgePose(set.pose, fix, Math.max(0, vehicle.path - set.path)));
    }
  }

  show() {
    const set = this.vehicle.initialPose;
    setText($("pose-verdict"), set?.text ?? "");
    $("pose-verdict").className = `verdict ${set?.verdict ?? ""}`;
  }
}

/// Draws poses on the floor: press at the place, drag into the heading. onPose gets each; returns a function that ends it.
export function drawPoses(floor, onPose) {
  const { element } = floor;
  const dragging = floor.leaflet.dragging;
  dragging.disable();
  element.classList.add("drawing");
  let start = null;
  const down = (event) => {
    if (event.button === 0 && !event.target.closest(".leaflet-control")) {
      start = { ...floor.metresAt(event), px: event.clientX, py: event.clientY };
      element.setPointerCapture(event.pointerId);
      onPose({ x: start.x, y: start.y, yaw: 0 });
    }
  };
  const move = (event) => {
    const far = start && Math.hypot(event.clientX - start.px, event.clientY - start.py) >= SHORTEST_DRAG_PX;
    if (far) {
      onPose({ x: start.x, y: start.y, yaw: Math.atan2(start.py - event.clientY, event.clientX - start.px) });
    }
  };
  const up = () => { start = null; };
  const listeners = { pointerdown: down, pointermove: move, pointerup: up, pointercancel: up };
  Object.entries(listeners).forEach(([name, listener]) => element.addEventListener(name, listener));
  return () => {
    Object.entries(listeners).forEach(([name, listener]) => element.removeEventListener(name, listener));
    dragging.enable();
    element.classList.remove("drawing");
  };
}
