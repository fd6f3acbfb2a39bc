// SPDX-License-Identifier: Apache-2.0
// What is drawn of single vehicles: fixes, trail, alternatives, a pose set by hand. to: {k, ox, oy}, pixels from metres.
import { covarianceEllipse } from "/web/data/geometry.js";
import { arrowPath, crossPath } from "/web/floor/sprites.js";
import { STATES } from "/web/words.js";

const FIX_PX = 20;

/// A path of an arrow at a pose, and what paint does with it.
function atPose(context, { k, ox, oy }, pose, paint) {
  context.save();
  context.translate(k * pose.x + ox, oy - k * pose.y);
  context.rotate(-pose.yaw);
  paint(context);
  context.restore();
}

function fixColour(fix, colours) {
  if (fix.status === "ambiguous") {
    return colours.ambiguous;
  }
  return fix.accepted === false ? colours.lost : colours.localized;
}

/// Single images: outlined arrows that fade with age; a rejected one is crossed out.
export function drawFixes(context, to, fixes, colours) {
  fixes.forEach((fix, i) => {
    context.globalAlpha = 0.3 + (0.7 * (i + 1)) / fixes.length;
    for (const pose of fix.pose ? [fix.pose] : fix.alternatives) {
      drawFix(context, to, pose, fix, fixColour(fix, colours));
    }
  });
  context.globalAlpha = 1;
}

function drawFix(context, to, pose, fix, colour) {
  atPose(context, to, pose, () => {
    context.strokeStyle = colour;
    context.lineWidth = 2;
    if (pose.covariance) {
      const { major, minor, angle } = covarianceEllipse(pose.covariance);
      if (major * to.k > 3) {
        context.beginPath();
        context.ellipse(0, 0, major * to.k, minor * to.k, pose.yaw - angle, 0, 2 * Math.PI);
        context.stroke();
      }
    }
    arrowPath(context, FIX_PX);
    context.fillStyle = "rgba(255, 255, 255, 0.55)";
    context.fill();
    context.stroke();
    if (fix.accepted === false) {
      crossPath(context, 7);
      context.stroke();
    }
  });
}

export function drawTrail(context, { k, ox, oy }, vehicle, colours) {
  context.beginPath();
  vehicle.motion.forTrail((x, y, begins) => context[begins ? "moveTo" : "lineTo"](k * x + ox, oy - k * y));
  context.lineJoin = "round";
  context.strokeStyle = colours.panel;
  context.lineWidth = 5;
  context.globalAlpha = 0.6;
  context.stroke();
  context.strokeStyle = colours.accent;
  context.lineWidth = 2;
  context.globalAlpha = 1;
  context.stroke();
}

/// How labels look, before putLabel.
export function styleLabels(context, colours, px) {
  context.font = `600 ${px}px system-ui, 'DejaVu Sans', sans-serif`;
  context.textBaseline = "middle";
  context.lineWidth = 3;
  context.lineJoin = "round";
  context.strokeStyle = colours.panel;
  context.fillStyle = colours.ink;
}

export function putLabel(context, text, x, y) {
  context.strokeText(text, x, y);
  context.fillText(text, x, y);
}

function label(context, { k, ox, oy }, pose, text, colours) {
  styleLabels(context, colours, 12);
  putLabel(context, text, k * pose.x + ox + 17, oy - k * pose.y);
}

/// The places where an ambiguous vehicle may be: the likelier, the less faded.
export function drawAlternatives(context, to, vehicle, colours) {
  for (const place of vehicle.alternatives()) {
    const weight = place.weight ?? 0;
    context.globalAlpha = 0.3 + 0.6 * weight;
    atPose(context, to, place, () => {
      arrowPath(context, 30);
      context.fillStyle = colours.ambiguous;
      context.strokeStyle = "#ffffff";
      context.lineWidth = 2;
      context.fill();
      context.stroke();
    });
    context.globalAlpha = 1;
    label(context, to, place, `${vehicle.id}? ${Math.round(100 * weight)} %`, colours);
  }
}

const VERDICTS = {
  draft: { colour: "accent", text: "" },
  waiting: { colour: "accent", text: "waiting for the next image" },
  confirmed: { colour: "localized", text: `${STATES.localized.sign} confirmed` },
  contradicted: { colour: "lost", text: `${STATES.lost.sign} contradicted` },
};

/// A pose set by hand: dashed until the next image confirms or contradicts it; then a line to where that is.
export function drawInitialPose(context, to, { pose, verdict, seen }, colours) {
  const { colour, text } = VERDICTS[verdict];
  const { k, ox, oy } = to;
  context.strokeStyle = colours[colour];
  context.fillStyle = "rgba(255, 255, 255, 0.5)";
  context.lineWidth = 2.5;
  if (seen) {
    context.setLineDash([3, 4]);
    context.beginPath();
    context.moveTo(k * pose.x + ox, oy - k * pose.y);
    context.lineTo(k * seen.x + ox, oy - k * seen.y);
    context.stroke();
  }
  context.setLineDash(verdict === "confirmed" ? [] : [5, 4]);
  atPose(context, to, pose, () => {
    arrowPath(context, 40);
    context.fill();
    context.stroke();
    context.beginPath();
    context.arc(0, 0, 26, 0, 2 * Math.PI);
    context.stroke();
  });
  context.setLineDash([]);
  if (text) {
    label(context, { k, ox: ox + 14, oy }, pose, text, colours);
  }
}
