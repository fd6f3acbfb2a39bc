// SPDX-License-Identifier: Apache-2.0
// One vehicle: state, numbers, what is wrong with it, and its last images.
import * as api from "/web/data/api.js";
import { $, h, setText, syncList } from "/web/dom.js";
import { InitialPoseForm } from "/web/panels/initial_pose.js";
import { Sparkline } from "/web/panels/sparkline.js";
import { STATES, degrees, sayClock, sayDuration, sayLength, sayOutcome, sayPose, sayProbability } from "/web/words.js";

const DETAILS_MS = 2000;
const DIAGNOSIS_MS = 10000;

const FINDING_SIGNS = { wrong: "✕", note: "!", unknown: "?", ok: "✓" };
const CAMERA_WORDS = {
  learning: "still learning whether it is as calibrated",
  as_calibrated: "as calibrated",
  corrected: "corrected by its fixes",
  implausible: "calibration off: calibrate or mount it anew",
};

const sigmaOf = (covariance) => Math.sqrt(Math.max(covariance[0], covariance[4]));

function saySinceFix(since) {
  if (!since) {
    return "none yet";
  }
  const { seconds, metres, radians } = since;
  return `${sayDuration(seconds)}, ${metres.toFixed(2)} m, ${degrees(radians).toFixed(0)}° of turns`;
}

function sayCamera({ status, off_px: off, fixes }) {
  const words = CAMERA_WORDS[status] ?? status;
  return status === "learning" ? `${words} (${fixes} so far)` : `${words} (${off.toFixed(1)} px off)`;
}

function sayOdometry(odometry) {
  if (!odometry) {
    return "none";
  }
  return odometry.cure ? `${odometry.health}. ${odometry.cure}` : odometry.health;
}

function countRejected({ accepted, rejected }) {
  const total = Object.values(rejected).reduce((sum, count) => sum + count, 0);
  return `${accepted} accepted, ${total} rejected`;
}

/// [name, text] rows; details: GET /v1/vehicles/{id}, or what a recorded drive has of it; null before it came.
function factsOf(vehicle, details) {
  const { pose } = vehicle;
  const fix = vehicle.lastFix();
  const facts = [
    ["Map", vehicle.map],
    ["Place", pose ? sayPose(pose) : "unknown"],
    ["Uncertainty", pose ? `±${sayLength(sigmaOf(pose.covariance))}, ±${degrees(Math.sqrt(pose.covariance[8])).toFixed(2)}°` : "–"],
    ["Since the last fix", saySinceFix(details?.since_fix)],
    ["Risk of error", fix?.status === "localized" ? sayProbability(fix.pWrong) : "–"],
  ];
  if (details) {
    facts.push(["Fixes", countRejected(details.fixes)], ["Odometry", sayOdometry(vehicle.odometry)]);
  }
  if (details?.camera_estimate) {
    facts.push(["Camera", sayCamera(details.camera_estimate)]);
  }
  return facts;
}

export class VehiclePanel {
  /// handlers: onClose(), onFollow(on), onTrail(on), onInspect(), and those of InitialPoseForm.
  constructor(handlers) {
    this.handlers = handlers;
    this.vehicle = null;
    this.curves = {
      inliers: new Sparkline("Agreeing points", (value) => value.toFixed(0)),
      pWrong: new Sparkline("Probability wrong", sayProbability, "log"),
      rms: new Sparkline("Residual", sayLength),
    };
    $("panel-curves").replaceChildren(...Object.values(this.curves).map(({ element }) => element));
    this.form = new InitialPoseForm(handlers);
    $("panel-close").addEventListener("click", () => handlers.onClose());
    $("panel-inspect").addEventListener("click", () => handlers.onInspect());
    for (const [id, change] of [["panel-follow", handlers.onFollow], ["panel-trail", handlers.onTrail]]) {
      $(id).addEventListener("click", ({ currentTarget }) => change(currentTarget.getAttribute("aria-pressed") !== "true"));
    }
  }

  press(id, on) {
    $(id).setAttribute("aria-pressed", String(on));
  }

  /// vehicle: null closes the panel.
  open(vehicle) {
    if (vehicle === this.vehicle) {
      return;
    }
    this.vehicle = vehicle;
    this.details = null;
    this.asked = { details: 0, diagnosis: 0 };
    $("panel").hidden = !vehicle;
    $("panel").classList.toggle("recorded", Boolean(vehicle?.recorded));
    $("panel-findings").replaceChildren();
    this.form.open(vehicle);
    if (vehicle) {
      setText($("panel-name"), vehicle.id);
    }
  }

  show(now) {
    const { vehicle } = this;
    if (!vehicle) {
      return;
    }
    this.ask();
    const { word, sign } = STATES[vehicle.state] ?? STATES.lost;
    $("panel-state").className = `state ${vehicle.state}`;
    setText($("panel-state"), `${sign} ${word}`);
    setText($("panel-since"), vehicle.sinceKnown ? `for ${sayDuration(now - vehicle.since)}` : `since before ${sayClock(vehicle.since)}`);
    syncList($("panel-facts"), factsOf(vehicle, this.details), {
      key: ([name]) => name,
      create: ([name]) => h("div", {}, h("dt", {}, name), h("dd")),
      update: (row, [, text]) => setText(row.lastChild, text),
    });
    this.showFixes(vehicle);
    this.form.show();
  }

  showFixes({ fixes, id, map }) {
    const newest = [...fixes].reverse();
    $("panel-no-fix").hidden = fixes.length > 0;
    $("panel-inspect").disabled = fixes.length === 0;
    setText($("panel-no-fix-command"), "curl --data-binary @frame.jpg -H 'Content-Type: image/jpeg' "
      + `'${location.origin}/v1/vehicles/${id}/frames?stamp='$(date +%s.%N)`);
    syncList($("panel-fixes"), newest, {
      key: ({ sequence }) => `${map} ${sequence}`,
      create: () => h("li", {}, h("time"), h("span")),
      update: (row, fix) => {
        row.className = fix.accepted === false || fix.status !== "localized" ? "bad" : "good";
        setText(row.firstChild, sayClock(fix.received));
        setText(row.lastChild, `${row.className === "good" ? "✓" : "✕"} ${sayOutcome(fix)}${fix.warning ? `. ${fix.warning}` : ""}`);
      },
    });
    const localized = (pick) => fixes.map((fix) => (fix.status === "localized" ? pick(fix) : null));
    this.curves.inliers.show(fixes.map(({ inliers }) => inliers));
    this.curves.pWrong.show(fixes.map(({ pWrong }) => pWrong));
    this.curves.rms.show(localized(({ rms }) => rms));
  }

  /// Asks the server for what no event tells, not more often than needed.
  async ask() {
    const { vehicle, asked } = this;
    if (vehicle.recorded) {
      this.details = vehicle.details;
      return;
    }
    const time = performance.now();
    const ask = async (what, interval, get, take) => {
      if (asked[what] && time - asked[what] < interval) {
        return;
      }
      asked[what] = time;
      const answer = await get(vehicle.id).catch(() => null);
      if (answer && vehicle === this.vehicle) {
        take(answer);
      }
    };
    await Promise.all([
      ask("details", DETAILS_MS, api.getVehicle, (details) => { this.details = details; }),
      ask("diagnosis", DIAGNOSIS_MS, api.getDiagnosis, ({ findings }) => this.showFindings(findings)),
    ]);
  }

  showFindings(findings) {
    const rank = Object.keys(FINDING_SIGNS);
    const sorted = [...findings].sort((a, b) => rank.indexOf(a.status) - rank.indexOf(b.status));
    $("panel-findings").replaceChildren(...sorted.map(({ about, status, sentence, cure }) =>
      h("li", { class: status }, h("span", { class: "sign", "aria-hidden": "true" }, FINDING_SIGNS[status]),
        h("span", {}, h("b", {}, `${about}: `), `${sentence}. `, cure && h("em", {}, cure)))));
  }
}
