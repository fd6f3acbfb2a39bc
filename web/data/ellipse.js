// SPDX-License-Identifier: Apache-2.0

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
