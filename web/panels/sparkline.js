// SPDX-License-Identifier: Apache-2.0
// Small curves of a vehicle's last images.

const NS = "http://www.w3.org/2000/svg";
const WIDTH = 160;
const HEIGHT = 32;

function make(tag, attributes) {
  const element = document.createElementNS(NS, tag);
  Object.entries(attributes).forEach(([name, value]) => element.setAttribute(name, value));
  return element;
}

/// A curve with a name, the last value in words, and its range for screen readers. values: null where there is none.
export class Sparkline {
  /// say(value): for people; scale: "log" or "linear".
  constructor(name, say, scale = "linear") {
    this.name = name;
    this.say = say;
    this.map = scale === "log" ? (value) => Math.log10(Math.max(1e-12, value)) : (value) => value;
    this.svg = make("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "sparkline", role: "img", preserveAspectRatio: "none" });
    this.path = make("path", { fill: "none", "vector-effect": "non-scaling-stroke" });
    this.svg.append(this.path);
    this.value = document.createElement("b");
    this.element = document.createElement("div");
    this.element.className = "spark";
    const title = document.createElement("span");
    title.textContent = name;
    this.element.append(title, this.svg, this.value);
  }

  show(values) {
    const known = values.filter((value) => value !== null);
    const last = known[known.length - 1];
    this.value.textContent = last === undefined ? "–" : this.say(last);
    this.svg.setAttribute("aria-label", known.length === 0 ? `${this.name}: none yet`
      : `${this.name} of the last ${known.length} images: from ${this.say(Math.min(...known))} to ${this.say(Math.max(...known))}`);
    this.path.setAttribute("d", this.pathOf(values, known));
  }

  pathOf(values, known) {
    const low = Math.min(...known.map(this.map));
    const span = Math.max(...known.map(this.map)) - low || 1;
    let pen = "M";
    return values.map((value, i) => {
      if (value === null) {
        pen = "M";
        return "";
      }
      const x = values.length > 1 ? (i / (values.length - 1)) * WIDTH : WIDTH;
      const y = HEIGHT - 3 - ((this.map(value) - low) / span) * (HEIGHT - 6);
      const step = `${pen}${x.toFixed(1)} ${y.toFixed(1)}`;
      pen = "L";
      return step;
    }).join("");
  }
}
