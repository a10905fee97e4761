// SPDX-License-Identifier: BSD-3-Clause
// One panel of a chart: axes, bands and curves within a box of pixels.

/** The vertical axis that shows all of a panel's curves that are not hidden. */
function wholeVerticalAxis(panel, isHidden) {
  const {logarithmic, low, high} = panel.axis;
  if (high !== null) return {logarithmic, from: low, to: high};
  let greatest = 0;
  for (const curve of panel.curves) {
    if (isHidden(curve)) continue;
    for (const value of curve.y) {
      if (value !== null && Number.isFinite(value)) greatest = Math.max(greatest, value);
    }
  }
  for (const {upper} of panel.bands) {
    if (Number.isFinite(upper)) greatest = Math.max(greatest, upper);
  }
  return {logarithmic, from: low, to: greatest > low ? 1.05 * greatest : low + 1};
}

/** Index of the first of increasing values that is not below `x`. */
function firstFrom(values, x) {
  let low = 0, high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < x) low = middle + 1;
    else high = middle;
  }
  return low;
}

class Plot {
  /**
   * @param panel of the chart's data. @param parent SVG element to draw into.
   * @param x_names of the places 0, 1, ... of the horizontal axis, in place of numbers.
   */
  constructor(panel, parent, x_names = null) {
    this.panel = panel;
    this.x_names = x_names;
    this.group = svgElement("g", {class: "panel"}, parent);
    this.zoomed = null;  // the vertical axis, where it does not show everything
  }

  /** Beside it, in a chart of this width [px]. */
  margins(width) {
    return {left: width < CHART.narrow ? 44 : 58, right: CHART.right};
  }

  /** [px]; null: the usual one. */
  wantedHeight() {
    return null;
  }

  place(box) {
    this.box = box;
  }

  x(value) {
    return this.box.left + shareOf(this.horizontal, value) * this.box.width;
  }

  /** Far outside the box is as good as at infinity, and no trouble to a renderer. */
  y(value) {
    const share = clamp(shareOf(this.vertical, value), -2, 3);
    return this.box.top + (1 - share) * this.box.height;
  }

  /** Where a place lies between the ends of both axes. */
  sharesOf({x, y}) {
    const {left, top, width, height} = this.box;
    return {x: (x - left) / width, y: (top + height - y) / height};
  }

  draw(horizontal, isHidden) {
    this.whole = wholeVerticalAxis(this.panel, isHidden);
    this.horizontal = horizontal;
    this.vertical = this.zoomed ?? this.whole;
    this.group.replaceChildren();
    this.drawGrid();
    const inside = this.addInside();
    for (const band of this.panel.bands) this.drawBand(band, inside);
    for (const curve of this.panel.curves) {
      if (!isHidden(curve)) this.drawCurve(curve, inside);
    }
    for (const marks of this.panel.marks ?? []) {
      if (!isHidden(marks)) drawMarks(marks, this, inside);
    }
    this.drawLabel();
  }

  /** What lies outside the box is not seen in this. */
  addInside() {
    const {left, top, width, height} = this.box;
    return svgElement("svg", {x: left, y: top, width, height,
      viewBox: [left, top, width, height].join(" ")}, this.group);
  }

  /** As much as there is room for. */
  drawLabel() {
    const {left, room, top, width} = this.box;
    const {label} = this.panel;
    const element = svgElement("text", {x: left - room, y: top - 11, class: "label", text: label},
                               this.group);
    const share = (room + width) / element.getComputedTextLength();
    if (share < 1) element.textContent = `${label.slice(0, share * label.length - 2)}…`;
  }

  drawGrid() {
    const {left, top, width, height} = this.box;
    for (const tick of ticksOf(this.vertical, Math.max(2, height / 36))) {
      svgElement("path", {class: "grid", d: `M${left} ${this.y(tick)}h${width}`}, this.group);
      svgElement("text", {class: "y tick", x: left - 6, y: this.y(tick) + 4,
        text: readable(tick)}, this.group);
    }
    this.drawTimes();
    svgElement("path", {class: "frame", d: `M${left} ${top}v${height}h${width}`}, this.group);
  }

  /** The values of the ticks of the horizontal axis, with their texts. */
  timesOf() {
    const {from, to} = this.horizontal;
    const isShown = ([value]) => value >= from && value <= to;
    return this.x_names ? this.x_names.map((name, k) => [k, name]).filter(isShown)
      : ticksOf(this.horizontal, Math.max(2, this.box.width / 90))
        .map((tick) => [tick, readable(tick)]);
  }

  /** Ticks of the horizontal axis. */
  drawTimes() {
    const {top, height} = this.box;
    for (const [value, text] of this.timesOf()) {
      svgElement("path", {class: "grid", d: `M${this.x(value)} ${top}v${height}`}, this.group);
      if (!this.box.lowest) continue;
      svgElement("text", {class: "x tick", x: this.x(value), y: top + height + 17, text},
                 this.group);
    }
  }

  drawBand(band, parent) {
    const top = this.y(band.upper), height = Math.max(this.y(band.lower) - top, 1);
    svgElement("rect", {class: "band", x: this.box.left, y: top, width: this.box.width,
      height}, parent);
  }

  drawCurve(curve, parent) {
    if (curve.envelope) {
      svgElement("path", {class: "envelope", "data-cell": curve.legend,
        d: this.areaOf(curve.envelope), fill: lineStyle(curve).stroke}, parent);
    }
    svgElement("path", {class: "curve", "data-cell": curve.legend, d: this.pathOf(curve),
      ...lineStyle(curve)}, parent);
  }

  /** The area of so much around zero, a part for each stretch without a gap. */
  areaOf(envelope) {
    const {x} = this.panel;
    const corner = (side) => (i) =>
      `${this.x(x[i]).toFixed(1)} ${this.y(side * envelope[i]).toFixed(1)}`;
    let path = "", stretch = [];
    for (let i = 0; i <= x.length; ++i) {
      if (i < x.length && envelope[i] !== null) {
        stretch.push(i);
        continue;
      }
      const corners = [...stretch.map(corner(1)), ...stretch.reverse().map(corner(-1))];
      if (corners.length > 0) path += `M${corners.join("L")}Z`;
      stretch = [];
    }
    return path;
  }

  /** What is no number, or not positive on a logarithmic axis, is a gap. */
  pathOf(curve) {
    const {x} = this.panel;
    const begin = Math.max(firstFrom(x, this.horizontal.from) - 1, 0);
    const end = Math.min(firstFrom(x, this.horizontal.to) + 1, x.length);
    let path = "", pen = "M";
    for (let i = begin; i < end; ++i) {
      const value = curve.y[i];
      if (value === null || (this.vertical.logarithmic && value <= 0)) {
        pen = "M";
        continue;
      }
      path += `${pen}${this.x(x[i]).toFixed(1)} ${this.y(value).toFixed(1)}`;
      pen = "L";
    }
    return path;
  }
}
