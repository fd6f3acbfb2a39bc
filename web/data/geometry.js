// SPDX-License-Identifier: Apache-2.0
// Poses on the floor: {x, y, yaw}, metres and radians.

/// Semi-axes (m) and direction (rad) of the position's 3-sigma ellipse; covariance: 3x3 of (x, y, yaw), row-major.
export function covarianceEllipse(covariance) {
  const [xx, xy, , , yy] = covariance;
  const mean = (xx + yy) / 2;
  const spread = Math.hypot((xx - yy) / 2, xy);
  return {
    major: 3 * Math.sqrt(Math.max(0, mean + spread)),
    minor: 3 * Math.sqrt(Math.max(0, mean - spread)),
    angle: Math.atan2(2 * xy, xx - yy) / 2,
  };
}

/// An angle within half a turn.
export const wrapAngle = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));

export const distance = (a, b) => Math.hypot(a.x - b.x, a.y - b.y);

/// Writes the pose between two others into out, the shorter way round. share: 0 at the first, 1 at the second.
export function between(from, to, share, out) {
  out.x = from.x + share * (to.x - from.x);
  out.y = from.y + share * (to.y - from.y);
  out.yaw = share === 1 ? to.yaw : from.yaw + share * wrapAngle(to.yaw - from.yaw);
  return out;
}
