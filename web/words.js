// SPDX-License-Identifier: Apache-2.0
// The words of the page: states, reasons, times and numbers for people.

/// Every state has a sign of its own, so that colour is never alone. In the order of their urgency.
export const STATES = {
  lost: { word: "lost", sign: "✕" },
  ambiguous: { word: "ambiguous", sign: "?" },
  stale: { word: "silent", sign: "○" },
  tracking_odometry: { word: "on odometry", sign: "◐" },
  localized: { word: "localized", sign: "●" },
  untracked: { word: "single images only", sign: "◇" }, // without a pose on the server: it calls localize
};

const REASONS = {
  too_few_keypoints: "the image shows too little texture",
  too_few_matches: "too little of the image is like the map",
  too_few_inliers: "too few points agree on a place",
  not_significant: "no more agreement than chance",
  contradicts_prior: "it fits better elsewhere than where it was expected",
  view_disagrees: "only a part of the view agrees with the map",
  no_floor: "no floor in view",
  other_floor: "a floor that the map does not have",
  wrong_fix_risk: "too likely to be wrong",
  jump_distance: "too far from the expected place",
  jump_angle: "turned too far from the expected heading",
  mahalanobis: "does not agree with the expected pose",
  too_old: "came too late",
  duplicate: "same time as an earlier message",
  invalid: "numbers out of range",
};

export const sayReason = (code) => REASONS[code] ?? code.replaceAll("_", " ");

/// "8 s", "12 min", "3 h", "2 d"
export function sayDuration(seconds) {
  const s = Math.max(0, seconds);
  if (s < 100) {
    return `${s.toFixed(0)} s`;
  }
  if (s < 6000) {
    return `${(s / 60).toFixed(0)} min`;
  }
  return s < 172800 ? `${(s / 3600).toFixed(0)} h` : `${(s / 86400).toFixed(0)} d`;
}

const CLOCK = new Intl.DateTimeFormat(undefined, { hour: "2-digit", minute: "2-digit", second: "2-digit", hour12: false });
export const sayClock = (unixSeconds) => CLOCK.format(unixSeconds * 1000);

const DATE = new Intl.DateTimeFormat(undefined, { day: "numeric", month: "short", hour: "2-digit", minute: "2-digit", hour12: false });
export const sayDate = (unixSeconds) => DATE.format(unixSeconds * 1000);

export const degrees = (radians) => (radians * 180) / Math.PI;
export const radians = (deg) => (deg * Math.PI) / 180;

export const sayPose = ({ x, y, yaw }) => `${x.toFixed(3)}, ${y.toFixed(3)} m, ${degrees(yaw).toFixed(1)}°`;

/// 12 mm, 3.4 cm, 2.30 m
export function sayLength(metres) {
  if (metres < 0.0995) {
    return `${(metres * 1000).toFixed(metres < 0.01 ? 1 : 0)} mm`;
  }
  return `${metres.toFixed(2)} m`;
}

export function sayProbability(p) {
  return p < 0.001 ? p.toExponential(0).replace("e-", "e−") : p.toFixed(3);
}

/// What became of an image.
export function sayOutcome({ status, reason, pose, accepted, rejectReason, reanchored, alternatives }) {
  if (status === "ambiguous") {
    return `${alternatives.length} places look like it`;
  }
  if (status !== "localized") {
    return `not found: ${sayReason(reason ?? "not_significant")}`;
  }
  if (accepted === false) {
    return `rejected: ${sayReason(rejectReason ?? "mahalanobis")}`;
  }
  return reanchored ? `found elsewhere: ${sayPose(pose)}` : sayPose(pose);
}
