// SPDX-License-Identifier: BSD-3-Clause
// What the curves say at the pointer.

/** Index of the value nearest to `x`. */
function nearest(values, x) {
  const after = clamp(firstFrom(values, x), 0, values.length - 1);
  const before = Math.max(after - 1, 0);
  return x - values[before] < values[after] - x ? before : after;
}

/** What all curves of a plot that are shown say at the value nearest to the pointer. */
function valuesAt(plot, at, isHidden, x_label) {
  const share = plot.sharesOf(at).x;
  if (share < 0 || share > 1) return null;
  const {x, curves} = plot.panel;
  const i = nearest(x, valueAt(plot.horizontal, share));
  const text = ({y, envelope}) => readable(y[i]) +
    (y[i] !== null && envelope ? ` (within ±${readable(envelope[i])})` : "");
  const rows = curves.filter((curve) => !isHidden(curve))
    .map((curve) => ({sample: curve, name: curve.legend, text: text(curve)}));
  return {title: sentence(x_label, x[i]), rows, value: x[i], x: plot.x(x[i]), y: plot.box.top};
}

class Readout {
  constructor(parent) {
    this.element = htmlElement("div", {class: "readout", hidden: "", "aria-live": "off"}, parent);
  }

  hide() {
    this.element.hidden = true;
  }

  /** A title over rows {name, text, sample: a curve, if there is one}, beside the place (x, y). */
  show({title, rows, x, y}) {
    this.element.replaceChildren();
    htmlElement("div", {class: "soft", text: title}, this.element);
    const table = htmlElement("table", {}, this.element);
    for (const {sample, name, text} of rows) {
      const row = htmlElement("tr", {}, table);
      const key = htmlElement("td", {}, row);
      if (sample) {
        const drawing = svgElement("svg", {width: 16, height: 8, "aria-hidden": "true"}, key);
        svgElement("path", {class: "curve", d: "M0 4H16", ...lineStyle(sample)}, drawing);
      }
      key.append(name);
      htmlElement("td", {class: "right", text}, row);
    }
    this.element.hidden = false;
    this.place({x, y});
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

/** "time [s]" and 12.5 as ["time", "12.5 s"]. */
function nameAndText(label, value, digits) {
  const [, name, unit] = /^(.*?)(?: \[(.*)\])?$/.exec(label);
  return [name, `${readable(value, digits)}${unit && unit !== "1" ? ` ${unit}` : ""}`];
}

function sentence(label, value) {
  return nameAndText(label, value, 5).join(" ");
}
