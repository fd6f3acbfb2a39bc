// SPDX-License-Identifier: Apache-2.0
// The motion of a vehicle between its poses, each at its own time.
import { between } from "/web/data/geometry.js";

const SAMPLES = 12;
const SHORTEST_DELAY_S = 0.12;
const LONGEST_DELAY_S = 1.2;
const CLOCK_STEP_S = 1.5; // a clock that is further off than its messages are late was set
const TRAIL_POINTS = 400;
const TRAIL_STEP_M = 0.03;

/// Poses are drawn a little late, so that the next one is there when it is needed: about one and a half intervals. The
/// vehicle's clock is not ours: its offset is the least that a message took.
export class Motion {
  constructor() {
    this.samples = [];
    this.epoch = null;
    this.offset = 0;
    this.interval = 0.1;
    this.shown = -Infinity; // stamp that was shown last
    this.trail = new Float32Array(2 * TRAIL_POINTS); // a ring of x, y
    this.trailLength = 0;
  }

  /// pose: x, y, yaw and its stamp (s); now: when it came (s).
  add(pose, epoch, now) {
    const last = this.samples[this.samples.length - 1];
    const delay = now - pose.stamp;
    const jump = epoch !== this.epoch || !last || pose.stamp < last.stamp || Math.abs(delay - this.offset) > CLOCK_STEP_S;
    if (jump) {
      this.samples.length = 0;
      this.offset = delay;
      this.shown = -Infinity;
      this.trailLength = epoch === this.epoch ? this.trailLength : 0;
      this.epoch = epoch;
    } else {
      this.offset = Math.min(delay, this.offset + 0.01 * (delay - this.offset));
      this.interval += 0.2 * (Math.min(LONGEST_DELAY_S, pose.stamp - last.stamp) - this.interval);
    }
    if (last?.stamp === pose.stamp) {
      this.samples.pop();
    }
    this.samples.push({ x: pose.x, y: pose.y, yaw: pose.yaw, stamp: pose.stamp });
    if (this.samples.length > SAMPLES) {
      this.samples.shift();
    }
    this.addToTrail(pose);
  }

  addToTrail({ x, y }) {
    const last = 2 * ((this.trailLength - 1 + TRAIL_POINTS) % TRAIL_POINTS);
    if (this.trailLength > 0 && Math.hypot(x - this.trail[last], y - this.trail[last + 1]) < TRAIL_STEP_M) {
      return;
    }
    const at = 2 * (this.trailLength % TRAIL_POINTS);
    this.trail[at] = x;
    this.trail[at + 1] = y;
    this.trailLength += 1;
  }

  /// Calls visit(x, y) for the points of the trail, oldest first.
  forTrail(visit) {
    for (let i = Math.max(0, this.trailLength - TRAIL_POINTS); i < this.trailLength; i += 1) {
      const at = 2 * (i % TRAIL_POINTS);
      visit(this.trail[at], this.trail[at + 1]);
    }
  }

  /// Writes the pose to show at a time (s) into out; false without any.
  at(now, out) {
    const { samples } = this;
    if (samples.length === 0) {
      return false;
    }
    const delay = Math.min(LONGEST_DELAY_S, Math.max(SHORTEST_DELAY_S, 1.5 * this.interval + 0.05));
    // What is learnt of clock and interval may hold the vehicle, but does not move it back.
    const time = Math.max(this.shown, now - this.offset - delay);
    this.shown = time;
    let after = samples.length - 1;
    while (after > 0 && samples[after - 1].stamp > time) {
      after -= 1;
    }
    const to = samples[after];
    const from = samples[Math.max(0, after - 1)];
    const span = to.stamp - from.stamp;
    const share = span > 0 ? Math.min(1, Math.max(0, (time - from.stamp) / span)) : 1;
    between(from, to, share, out);
    return true;
  }
}
