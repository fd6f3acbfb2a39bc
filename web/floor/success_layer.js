// SPDX-License-Identifier: Apache-2.0
// Where images are found, square by square of the floor, over where the map itself is weak.
import { putLabel, styleLabels } from "/web/floor/details.js";

const LABELLED_PX = 34; // side of a square from which on it holds its percentage

/// Classes of squares by the share of images found there, with colour and opacity: the less is found, the darker.
export const CLASSES = [
  { name: "most", least: 0.95, colour: "localized", alpha: 0.3 },
  { name: "many", least: 0.8, colour: "ambiguous", alpha: 0.4 },
  { name: "some", least: 0.5, colour: "lost", alpha: 0.5 },
  { name: "few", least: 0, colour: "lost", alpha: 0.8 },
];

export const shareOf = ({ found, missed }) => found / (found + missed);
const classOf = (cell) => CLASSES.findIndex(({ least }) => shareOf(cell) >= least);

/// The squares in view: visit(cell, x, y of the upper left corner, side), pixels.
function forSquares({ canvas }, { k, ox, oy }, cells, side, visit) {
  const s = k * side;
  for (const cell of cells) {
    const [x, y] = [k * cell.x + ox, oy - k * cell.y - s];
    if (x > -s && y > -s && x < canvas.width && y < canvas.height) {
      visit(cell, x, y, s);
    }
  }
}

function drawWeak(context, to, { weak, weakSide }, colours) {
  const hatch = new Path2D();
  forSquares(context, to, weak, weakSide, (_, x, y, s) => {
    for (let t = 0.125; t <= 1; t += 0.125) {
      hatch.moveTo(x + t * s, y);
      hatch.lineTo(x, y + t * s);
      hatch.moveTo(x + s, y + t * s);
      hatch.lineTo(x + t * s, y + s);
    }
  });
  context.strokeStyle = colours.ink;
  context.globalAlpha = 0.35;
  context.lineWidth = 1;
  context.stroke(hatch);
}

/// success: {cells, side, weak, weakSide}: squares as the server lists them, and those where the map is weak.
export function drawSuccess(context, to, success, colours) {
  drawWeak(context, to, success, colours);
  const fills = CLASSES.map(() => new Path2D());
  const again = new Path2D();
  forSquares(context, to, success.cells, success.side, (cell, x, y, s) => {
    fills[classOf(cell)].rect(x, y, s, s);
    if (cell.survey_again) {
      again.rect(x + 1.5, y + 1.5, s - 3, s - 3);
      again.moveTo(x + 1.5, y + 1.5);
      again.lineTo(x + s - 1.5, y + s - 1.5);
    }
  });
  fills.forEach((path, i) => {
    context.globalAlpha = CLASSES[i].alpha;
    context.fillStyle = colours[CLASSES[i].colour];
    context.fill(path);
  });
  context.globalAlpha = 1;
  context.lineWidth = 3;
  context.strokeStyle = colours.lost;
  context.stroke(again);
  if (to.k * success.side >= LABELLED_PX) {
    styleLabels(context, colours, 11);
    context.textAlign = "center";
    forSquares(context, to, success.cells, success.side, (cell, x, y, s) =>
      putLabel(context, `${Math.round(100 * shareOf(cell))} %`, x + s / 2, y + s / 2));
    context.textAlign = "start";
  }
}
