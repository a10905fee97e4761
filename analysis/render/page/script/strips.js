// SPDX-License-Identifier: BSD-3-Clause
// Rows of colours that say how many times too large or too small something is over time.

const STRIP = {thickness: 18, gap: 6, name: 17, character: 6.8, most: 0.35};

/** [px] */
function widthOfLongest(texts) {
  return Math.max(...texts.map(({length}) => length)) * STRIP.character;
}

class Strips extends Plot {
  /** @param end where the last column ends. */
  constructor(panel, parent, end) {
    super(panel, parent);
    this.begins = [...panel.x, end];
  }

  /** Names stand above their strips where they would take too much of the width. */
  margins(width) {
    const {rows} = this.panel.strips;
    const longest = (what) => widthOfLongest(rows.map((row) => row[what]));
    this.is_stacked = width < CHART.narrow || longest("name") > STRIP.most * width;
    return this.is_stacked ? {left: 4, right: CHART.right}
      : {left: longest("name") + 12, right: longest("note") + 14};
  }

  get pitch() {
    return STRIP.thickness + STRIP.gap + (this.is_stacked ? STRIP.name : 0);
  }

  wantedHeight() {
    return this.pitch * this.panel.strips.rows.length;
  }

  draw(horizontal) {
    this.horizontal = horizontal;
    this.group.replaceChildren();
    this.drawTimes();
    const inside = this.addInside();
    this.panel.strips.rows.forEach((row, r) => {
      const top = this.box.top + (r + 1) * this.pitch - STRIP.gap / 2 - STRIP.thickness;
      this.drawStrip(row, top, inside);
      this.drawWords(row, top);
    });
    this.drawLabel();
  }

  /** One path for each colour. */
  drawStrip({name, levels}, top, parent) {
    const {left, width} = this.box;
    svgElement("rect", {class: "none", x: left + 0.5, y: top + 0.5,
      width: width - 1, height: STRIP.thickness - 1}, parent);
    const group = svgElement("g", {class: "strips", "data-cell": name}, parent);
    const paths = new Map();
    for (let begin = 0, end; begin < levels.length; begin = end) {
      end = levels.findIndex((level, i) => i > begin && level !== levels[begin]);
      if (end < 0) end = levels.length;
      const [from, to] = [begin, end].map((i) =>
        clamp(this.x(this.begins[i]), left - 1, left + width + 1));
      if (from === to || levels[begin] < 0) continue;
      paths.set(levels[begin], `${paths.get(levels[begin]) ?? ""}M${px(from)} ${top}`
        + `H${px(to)}v${STRIP.thickness}H${px(from)}z`);
    }
    for (const [level, d] of paths) {
      svgElement("path", {d, style: `fill: ${this.panel.strips.colours[level]}`}, group);
    }
  }

  drawWords({name, note}, top) {
    const {left, width} = this.box;
    const y = this.is_stacked ? top - 4 : top + STRIP.thickness - 5;
    svgElement("text", {class: this.is_stacked ? "row" : "row end",
      x: this.is_stacked ? left : left - 6, y, text: name}, this.group);
    svgElement("text", {class: this.is_stacked ? "row end" : "row",
      x: left + width + (this.is_stacked ? 0 : 8), y, text: note}, this.group);
  }

  drawLabel() {
    const {left, top, width} = this.box;
    const {label, strips} = this.panel;
    svgElement("text", {class: "label", x: left, y: top - 8, text: label}, this.group);
    svgElement("text", {class: this.is_stacked ? "label end" : "label",
      x: left + width + (this.is_stacked ? 0 : 8), y: top - 8, text: strips.notes}, this.group);
  }
}

/** What the strip at the pointer says; null where there is none. */
function stripAt(plot, at, x_label) {
  const share = plot.sharesOf(at).x;
  const {label, strips, x} = plot.panel;
  const r = Math.floor((at.y - plot.box.top) / plot.pitch), row = strips.rows[r];
  if (!row || share < 0 || share > 1) return null;
  const value = valueAt(plot.horizontal, share);
  const column = x.findLastIndex((begin) => begin <= value);
  const line = (name, number, digits) => {
    const [key, text] = nameAndText(name, number, digits);
    return {name: key, text};
  };
  const rows = [line(x_label, value, 4), line(label, row.ratios[column], 3)];
  if (row.levels[column] === strips.colours.length - 1) rows.push({name: strips.inside, text: ""});
  return {title: row.name, rows, value, x: at.x, y: plot.box.top + (r + 1) * plot.pitch};
}

/** What the colours mean. */
function addStripKey({colours, scale, ticks, inside}, parent) {
  const step = 6, height = 12, margin = 16, levels = colours.length - 1;
  const entry = () => htmlElement("span", {class: "entry"}, parent);
  const bar = entry(), grey = entry();
  const drawing = svgElement("svg", {class: "key", width: step * levels + 2 * margin,
    height: 2 * height + 6, "aria-hidden": "true"}, bar);
  const place = (level) => margin + step * level;
  const box = (colour, attributes, sheet) => svgElement("rect", {class: "strips", height,
    style: `fill: ${colour}`, ...attributes}, sheet);
  colours.slice(0, levels).forEach((colour, level) =>
    box(colour, {x: place(level), y: 2, width: step}, drawing));
  for (const {level, text} of ticks) {
    svgElement("text", {x: place(level), y: 2 * height + 4, text}, drawing);
  }
  htmlElement("span", {class: "scale", text: scale}, bar);
  const sample = svgElement("svg", {width: 26, height, "aria-hidden": "true"}, grey);
  box(colours[levels], {width: 26}, sample);
  grey.append(inside);
}
