// SPDX-License-Identifier: BSD-3-Clause
// Rows of marks, such as boxes, with a name for each row in place of a vertical axis.

const ROW = {pitch: 26, stacked: 48};

class NamedRows extends Plot {
  /** Names tell rows apart, so no line is dashed. */
  constructor(panel, parent) {
    super(panel, parent);
    this.group.classList.add("rows");
    for (const marks of panel.marks) marks.dash = 1;
  }

  /** Names stand above their rows where they would take too much of the width. */
  margins(width) {
    const longest = widthOfLongest(this.panel.names);
    this.is_stacked = longest > STRIP.most * width;
    return {left: this.is_stacked ? 10 : longest + 12, right: CHART.right};
  }

  wantedHeight() {
    return this.panel.names.length * (this.is_stacked ? ROW.stacked : ROW.pitch);
  }

  drawGrid() {
    const {left, top, width, height} = this.box;
    this.drawTimes();
    svgElement("path", {class: "frame", d: `M${left} ${top}v${height}h${width}`}, this.group);
    this.panel.names.forEach((name, r) => svgElement("text", this.is_stacked
      ? {class: "row", x: left + 4, y: this.y(r - 0.3) - 4, text: name}
      : {class: "row end", x: left - 6, y: this.y(r) + 4, text: name}, this.group));
  }
}
