// SPDX-License-Identifier: BSD-3-Clause
// A figure that is zoomed into and asked: panels over one horizontal axis, a legend, a readout.

const CHART = {right: 14, top: 26, bottom: 44, narrow: 480};

class ChartFigure {
  constructor(figure, data) {
    this.data = data;
    data.panels.reduce((above, panel) => (panel.x ??= above), null);
    this.whole = {logarithmic: false, from: data.x_from, to: data.x_to};
    this.horizontal = {...this.whole};
    this.verticals = data.panels.map(() => null);
    const live = htmlElement("div", {class: "live"});
    figure.prepend(live);
    figure.classList.add("has-live");
    this.legend = new Legend(curvesOf(data), bandsOf(data), live, () => this.draw());
    this.stage = htmlElement("div", {class: "stage"}, live);
    this.svg = svgElement("svg", {class: "chart", tabindex: 0, role: "img",
      "aria-label": figure.querySelector("svg.drawing")?.getAttribute("aria-label") ?? "chart"},
    this.stage);
    this.plots = data.panels.map((panel) => new Plot(panel, this.svg));
    this.cursor = svgElement("path", {class: "cursor"}, this.svg);
    this.drawn_box = svgElement("rect", {class: "selection"}, this.svg);
    this.readout = new Readout(this.stage);
    this.addHint(live);
    this.gestures = new Gestures(this.svg, this);
    new ResizeObserver(() => this.layOut()).observe(this.stage);
    this.layOut();
  }

  addHint(parent) {
    const hint = htmlElement("div", {class: "hint"}, parent);
    const words = matchMedia("(pointer: coarse)").matches
      ? "Slide a finger to read values; two fingers zoom, a double tap shows all."
      : "Point to read values; drag a box to zoom, Shift and drag to move, Ctrl and wheel to zoom "
        + "in time; a double click shows all.";
    htmlElement("span", {text: words}, hint);
    this.all = htmlElement("button", {type: "button", text: "show all", hidden: ""}, hint);
    this.all.addEventListener("click", () => this.reset());
  }

  layOut() {
    const width = Math.max(this.stage.clientWidth, 200);
    if (width === this.width) return;
    this.width = width;
    const is_narrow = width < CHART.narrow;
    const room = is_narrow ? 44 : 58;
    const single = this.plots.length === 1;
    const height = is_narrow ? (single ? 210 : 150) : (single ? 300 : 180);
    this.plots.forEach((plot, p) => plot.place({left: room, room: room - 4, height,
      top: CHART.top + p * (height + CHART.top), width: width - room - CHART.right,
      lowest: p + 1 === this.plots.length}));
    this.height = this.plots.length * (height + CHART.top) + CHART.bottom;
    this.svg.setAttribute("width", width);
    this.svg.setAttribute("height", this.height);
    this.draw();
  }

  draw() {
    const isHidden = (curve) => this.legend.isHidden(curve);
    this.plots.forEach((plot, p) => {
      plot.whole = wholeVerticalAxis(plot.panel, isHidden);
      plot.draw(this.horizontal, this.verticals[p] ?? plot.whole, isHidden);
    });
    const last = this.plots.at(-1);
    svgElement("text", {class: "x name", x: last.box.left + last.box.width / 2,
      y: this.height - 8, text: this.data.x_label}, last.group);
    this.svg.dataset.from = this.horizontal.from;
    this.svg.dataset.to = this.horizontal.to;
    this.all.hidden = this.isWhole();
    this.point(null);
  }

  isWhole() {
    return this.horizontal.from === this.whole.from && this.horizontal.to === this.whole.to
      && this.verticals.every((axis) => axis === null);
  }

  plotAt(y) {
    return this.plots.find(({box}) => y >= box.top - CHART.top / 2
      && y <= box.top + box.height + CHART.top / 2) ?? null;
  }

  share(x) {
    const {box} = this.plots[0];
    return (x - box.left) / box.width;
  }

  point(at) {
    const plot = at && this.plotAt(at.y);
    const share = at ? this.share(at.x) : -1;
    this.cursor.toggleAttribute("hidden", true);
    if (!plot || share < 0 || share > 1) {
      this.readout.hide();
      return;
    }
    const i = nearest(plot.panel.x, valueAt(this.horizontal, share));
    const x = plot.x(plot.panel.x[i]);
    this.cursor.toggleAttribute("hidden", false);
    this.cursor.setAttribute("d", this.plots.map(({box}) => `M${x} ${box.top}v${box.height}`)
      .join(""));
    this.readout.show(plot, i, this.data.x_label, {x, y: plot.box.top},
                      (curve) => this.legend.isHidden(curve));
  }

  zoom(at, factor) {
    this.show(zoomed(this.horizontal, clamp(this.share(at.x), 0, 1), factor));
  }

  move(dx, dy) {
    const {box} = this.plots[0];
    const by = -dx / box.width;
    if (dy !== 0) this.verticals = this.verticals.map((axis) =>
      axis && stretch(axis, dy / box.height, 1 + dy / box.height));
    this.show(stretch(this.horizontal, by, 1 + by));
  }

  show(horizontal) {
    if (!isWideEnough(horizontal, this.whole)) return;
    this.horizontal = within(horizontal, this.whole);
    this.draw();
  }

  box(from, to) {
    this.drawn_box.toggleAttribute("hidden", !from);
    if (!from) return;
    this.readout.hide();
    fill(this.drawn_box, {x: Math.min(from.x, to.x), y: Math.min(from.y, to.y),
      width: Math.abs(to.x - from.x), height: Math.abs(to.y - from.y)});
  }

  /** A flat box zooms in time alone, a narrow one in height alone. */
  select(from, to) {
    const plot = this.plotAt((from.y + to.y) / 2);
    const order = (a, b) => [Math.min(a, b), Math.max(a, b)];
    const flat = Math.abs(to.y - from.y) < 24, narrow = Math.abs(to.x - from.x) < 24;
    if (plot && !flat) {
      const up = (y) => clamp((plot.box.top + plot.box.height - y) / plot.box.height, 0, 1);
      this.verticals[this.plots.indexOf(plot)] = stretch(plot.vertical, ...order(up(from.y), up(to.y)));
    }
    const [first, last] = order(this.share(from.x), this.share(to.x));
    this.show(narrow && !flat ? this.horizontal : stretch(this.horizontal, first, last));
  }

  reset() {
    this.verticals.fill(null);
    this.show(this.whole);
  }
}

/** The first curve of each cell, over all panels. */
function curvesOf(data) {
  const curves = new Map();
  for (const panel of data.panels) {
    for (const curve of panel.curves) {
      if (!curves.has(curve.legend)) curves.set(curve.legend, curve);
    }
  }
  return [...curves.values()];
}

function bandsOf(data) {
  return data.panels[0].bands.filter((band) => band.legend);
}
