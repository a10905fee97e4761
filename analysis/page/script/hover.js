// SPDX-License-Identifier: BSD-3-Clause
// What the curves say at the pointer.

/** Index of the value nearest to `x`. */
function nearest(values, x) {
  const after = clamp(firstFrom(values, x), 0, values.length - 1);
  const before = Math.max(after - 1, 0);
  return x - values[before] < values[after] - x ? before : after;
}

class Readout {
  constructor(parent) {
    this.element = htmlElement("div", {class: "readout", hidden: "", "aria-live": "off"}, parent);
  }

  hide() {
    this.element.hidden = true;
  }

  /** Values of all curves of `plot` that are shown, at index `i`, beside the place `at`. */
  show(plot, i, x_label, at, isHidden) {
    this.element.replaceChildren();
    const {panel} = plot;
    htmlElement("div", {class: "soft", text: sentence(x_label, panel.x[i])}, this.element);
    const table = htmlElement("table", {}, this.element);
    for (const curve of panel.curves) {
      if (isHidden(curve)) continue;
      const row = htmlElement("tr", {}, table);
      const key = htmlElement("td", {}, row);
      const sample = svgElement("svg", {width: 16, height: 8, "aria-hidden": "true"}, key);
      svgElement("path", {class: "curve", d: "M0 4H16", ...lineStyle(curve)}, sample);
      key.append(curve.legend);
      htmlElement("td", {class: "right", text: readable(curve.y[i])}, row);
    }
    this.element.hidden = false;
    this.place(at);
  }

  /** Beside the pointer, on the side where there is more room. */
  place(at) {
    const room = this.element.parentElement.clientWidth;
    const width = this.element.offsetWidth;
    const left = at.x + 16 + width < room ? at.x + 16 : at.x - 16 - width;
    this.element.style.left = `${clamp(left, 0, Math.max(room - width, 0))}px`;
    this.element.style.top = `${at.y}px`;
  }
}

/** "time [s]" and 12.5 as "time 12.5 s". */
function sentence(label, value) {
  const [, name, unit] = /^(.*?)(?: \[(.*)\])?$/.exec(label);
  return `${name} ${readable(value, 5)}${unit && unit !== "1" ? ` ${unit}` : ""}`;
}
