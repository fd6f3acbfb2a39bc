// SPDX-License-Identifier: Apache-2.0
// An image over the floor at a pose that it may have, with what its keypoints match there.

const NEAR_ZOOM = 1.5; // screen pixels of an image pixel above which pixels are shown as squares

/// A line in a colour, on a lighter one, so that it is seen on any floor.
function stroke(context, path, colour, width) {
  context.lineWidth = width + 2;
  context.strokeStyle = "rgba(255, 255, 255, 0.75)";
  context.stroke(path);
  context.lineWidth = width;
  context.strokeStyle = colour;
  context.stroke(path);
}

function ring(path, x, y, r) {
  path.moveTo(x + r, y);
  path.arc(x, y, r, 0, 2 * Math.PI);
}

function cross(path, x, y, r) {
  path.moveTo(x - r, y - r);
  path.lineTo(x + r, y + r);
  path.moveTo(x + r, y - r);
  path.lineTo(x - r, y + r);
}

/// region: of the base frame, whose +x is up in the image, and +y to the left.
function drawImage(context, { k, ox, oy }, { image, region, blend }, pose, colour) {
  const width = k * (region.y_max - region.y_min);
  const height = k * (region.x_max - region.x_min);
  context.save();
  context.translate(k * pose.x + ox, oy - k * pose.y);
  context.rotate(-pose.yaw);
  context.transform(0, 1, -1, 0, k * region.x_max, -k * region.y_max);
  context.globalAlpha = blend;
  context.imageSmoothingEnabled = width < NEAR_ZOOM * image.width;
  context.drawImage(image, 0, 0, width, height);
  context.globalAlpha = 1;
  const frame = new Path2D();
  frame.rect(0, 0, width, height);
  stroke(context, frame, colour, 2);
  context.restore();
}

/// A function from points of the base frame to the canvas.
function placer({ k, ox, oy }, { x, y, yaw }) {
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  return ([bx, by]) => [k * (x + c * bx - s * by) + ox, oy - k * (y + s * bx + c * by)];
}

function drawMatches(context, to, { keypoints }, { matches, ...pose }, colours) {
  const place = placer(to, pose);
  const r = Math.min(7, Math.max(2, 0.003 * to.k));
  const [dots, inliers, outliers] = [new Path2D(), new Path2D(), new Path2D()];
  const matched = new Set(matches.map(({ base }) => String(base)));
  keypoints.filter((point) => !matched.has(String(point))).forEach((point) => ring(dots, ...place(point), 0.4 * r));
  for (const { base, map, inlier } of matches) {
    const [x, y] = place(base);
    if (inlier) {
      ring(inliers, x, y, r);
    } else {
      cross(outliers, x, y, 0.8 * r);
      outliers.moveTo(x, y);
      outliers.lineTo(to.k * map[0] + to.ox, to.oy - to.k * map[1]);
    }
  }
  stroke(context, dots, colours.stale, 1);
  stroke(context, outliers, colours.lost, 1.5);
  stroke(context, inliers, colours.localized, 1.5);
}

/// inspection: {image, region, keypoints, blend, showMatches, pose: with its matches, rival: it is not that of the result}.
export function drawInspection(context, to, inspection, colours) {
  const { pose, rival, showMatches } = inspection;
  drawImage(context, to, inspection, pose, rival ? colours.ambiguous : colours.accent);
  if (showMatches) {
    drawMatches(context, to, inspection, pose, colours);
  }
}

/// Corners of the image on the floor, for a view of it: [{x, y}].
export function cornersOf({ region }, pose) {
  const place = placer({ k: 1, ox: 0, oy: 0 }, pose);
  return [[region.x_min, region.y_min], [region.x_min, region.y_max], [region.x_max, region.y_min], [region.x_max, region.y_max]]
    .map((corner) => place(corner)).map(([x, y]) => ({ x, y: -y }));
}
