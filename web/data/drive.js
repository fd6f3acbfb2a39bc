// SPDX-License-Identifier: Apache-2.0
// A recorded drive, by the lines of `localize --fuse --results`, and its vehicle as it was at any time.
import { between, covarianceEllipse } from "/web/data/geometry.js";
import { STATES } from "/web/words.js";

const LARGEST_BYTES = 300e6; // some 40 hours at one image a second
const FIXES_SHOWN = 50;
const TRAIL_POINTS = 2000;
const TUM_LINE = /^-?[\d.]+(e[-+]?\d+)?( -?[\d.]+(e[-+]?\d+)?){7}$/i;
const WANTED = "Choose the file that 'floorloc-mapbuilder localize --fuse --results FILE' wrote.";

const isPose = (pose) => [pose.x, pose.y, pose.yaw].every(Number.isFinite)
  && Array.isArray(pose.covariance) && pose.covariance.length === 9 && pose.covariance.every(Number.isFinite);

function parseLine(line, number) {
  const wrong = (what) => new Error(`Line ${number} ${what}. ${WANTED}`);
  let json;
  try {
    json = JSON.parse(line);
  } catch {
    throw wrong(TUM_LINE.test(line) || line.startsWith("#") ? "is one of a trajectory, as --out writes it" : "is no JSON");
  }
  if (!Number.isFinite(json?.timestamp) || typeof json.status !== "string") {
    throw wrong("has no timestamp and status");
  }
  if (json.fused === undefined) {
    throw wrong("has no fused pose: the drive was localized without --fuse");
  }
  if (json.fused && !(isPose(json.fused) && STATES[json.fused.state]) || json.status === "localized" && !isPose(json)) {
    throw wrong("has a pose without numbers or state");
  }
  return json;
}

/// As the server's fix records, shortened.
function fixOf(json, sequence) {
  const { timestamp, status, reason, accepted, reject_reason: rejectReason, reanchored, alternatives = [], warning } = json;
  return {
    sequence, received: timestamp, status, reason, accepted, rejectReason, reanchored, alternatives, warning,
    pose: status === "localized" ? { x: json.x, y: json.y, yaw: json.yaw, covariance: json.covariance } : undefined,
    inliers: json.inliers ?? 0, matches: json.matches ?? 0, pWrong: json.p_wrong ?? 1, rms: json.rms_m ?? 0,
  };
}

function stateOf({ fused, alternatives = [] }) {
  return !fused || fused.state === "lost" ? (alternatives.length > 0 ? "ambiguous" : "lost") : fused.state;
}

/// The vehicle of a drive: what the page shows of a live one.
export class Drive {
  /// Throws an Error of one sentence that says what is wrong with the text.
  constructor(name, text) {
    this.id = name;
    this.recorded = true;
    this.sinceKnown = true;
    this.initialPose = null;
    this.motion = this;
    this.frames = [];
    this.here = { x: 0, y: 0, yaw: 0 };
    text.split("\n").forEach((line, i) => line.trim() && this.add(parseLine(line.trim(), i + 1), i + 1));
    if (this.frames.length === 0) {
      throw new Error(`The file is empty. ${WANTED}`);
    }
    this.start = this.frames[0].time;
    this.end = this.frames.at(-1).time;
    this.seek(this.start);
  }

  static async read(file) {
    if (file.size > LARGEST_BYTES) {
      throw new Error(`The file has ${(file.size / 1e6).toFixed(0)} MB, and at most ${LARGEST_BYTES / 1e6} can be replayed: cut it, it has a line per image.`);
    }
    return new Drive(file.name, await file.text());
  }

  add(json, number) {
    const before = this.frames.at(-1);
    const { timestamp: time, status, fused, accepted, reanchored } = json;
    if (time < before?.time) {
      throw new Error(`Line ${number} is earlier than the one before it. ${WANTED}`);
    }
    const state = stateOf(json);
    this.frames.push({
      time, state, fused, fix: fixOf(json, number),
      since: state === before?.state ? before.since : time,
      begins: !before?.fused || Boolean(reanchored), // its pose does not go on from the one before
      accepted: (before?.accepted ?? 0) + (accepted === true),
      rejected: (before?.rejected ?? 0) + (status === "localized" && accepted === false),
    });
  }

  /// Takes the vehicle to a time, within the drive.
  seek(time) {
    this.time = Math.min(this.end, Math.max(this.start, time));
    let [low, high] = [0, this.frames.length - 1];
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      [low, high] = this.frames[middle].time <= this.time ? [middle, high] : [low, middle - 1];
    }
    if (low !== this.index) {
      this.index = low;
      this.takeFrame(this.frames[low]);
    }
  }

  takeFrame({ state, since, fused, accepted, rejected }) {
    Object.assign(this, { state, since, pose: fused, odometry: fused?.odometry });
    this.ellipse = fused ? covarianceEllipse(fused.covariance) : null;
    this.fixes = this.frames.slice(Math.max(0, this.index + 1 - FIXES_SHOWN), this.index + 1).map(({ fix }) => fix);
    this.details = { since_fix: fused?.since_fix, fixes: { accepted, rejected: { all: rejected } } };
  }

  lastFix() {
    return this.fixes.at(-1);
  }

  alternatives() {
    return this.state === "ambiguous" ? this.lastFix().alternatives : [];
  }

  /// As Motion.at, at the drive's own time.
  at(_, out) {
    const { frames, index, time } = this;
    const [from, to] = [frames[index], frames[index + 1]];
    if (!from.fused) {
      return false;
    }
    const share = to?.fused && !to.begins && to.time > from.time ? (time - from.time) / (to.time - from.time) : 0;
    between(from.fused, to?.fused ?? from.fused, share, out);
    return true;
  }

  /// As Motion.forTrail: the way so far; begins: not from the point before.
  forTrail(visit) {
    const stride = Math.ceil((this.index + 1) / TRAIL_POINTS);
    let begins = true;
    for (let i = 0; i <= this.index; i += 1) {
      const { fused, begins: jump } = this.frames[i];
      begins ||= jump || !fused;
      if (fused && (begins || i % stride === 0)) {
        visit(fused.x, fused.y, begins);
        begins = false;
      }
    }
    if (this.at(0, this.here)) {
      visit(this.here.x, this.here.y, false);
    }
  }

  /// Share of its poses within a rectangle.
  shareWithin({ x_min: left, x_max: right, y_min: low, y_max: high }) {
    const poses = this.frames.map(({ fused }) => fused).filter(Boolean);
    return poses.filter(({ x, y }) => x >= left && x <= right && y >= low && y <= high).length / Math.max(1, poses.length);
  }
}
