// SPDX-License-Identifier: BSD-3-Clause
// A figure that is zoomed into and asked: panels over one horizontal axis, a legend, a readout.

const CHART = {right: 14, top: 30, bottom: 44, narrow: 480, widest: 640, lowest: 80};

class ChartFigure {
  constructor(figure, data) {
    this.data = data;
    data.panels.reduce((above, panel) => (panel.x ??= above), null);
    this.whole = {logarithmic: data.x_logarithmic ?? false, from: data.x_from, to: data.x_to};
    this.horizontal = {...this.whole, from: data.x_first ?? data.x_from};
    const live = htmlElement("div", {class: "live"});
    figure.prepend(live);
    figure.classList.add("has-live");
    this.legend = new Legend(cellsOf(data), bandsOf(data), live, () => this.arrange());
    const {strips} = data.panels[0];
    if (strips) addStripKey(strips, this.legend.element);
    this.stage = htmlElement("div", {class: "stage"}, live);
    this.svg = svgElement("svg", {class: "chart", tabindex: 0, role: "img",
      "aria-label": figure.querySelector("svg.drawing")?.getAttribute("aria-label") ?? "chart"},
    this.stage);
    this.plots = data.panels.map((panel) => panel.strips
      ? new Strips(panel, this.svg, data.x_to)
      : panel.names ? new NamedRows(panel, this.svg) : new Plot(panel, this.svg, data.x_names));
    this.x_name = svgElement("text", {class: "x name", text: data.x_label}, this.svg);
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
    htmlElement("span", {text: handsSay("Point to read values; drag a box to zoom, Shift and drag "
      + "to move, Ctrl and wheel to zoom; a double click shows all.",
    "Slide a finger to read values; two fingers zoom, a double tap shows all.")}, hint);
    this.all = htmlElement("button", {type: "button", text: "show all", hidden: ""}, hint);
    this.all.addEventListener("click", () => this.reset());
  }

  layOut() {
    const width = Math.max(this.stage.clientWidth, 200);
    if (width === this.width) return;
    this.width = width;
    this.arrange();
  }

  /** Panels side by side as far as there is room; those of hidden cells leave theirs to others. */
  arrange() {
    const isShown = ({panel}) => !this.legend.hidden.has(panel.cell);
    this.shown = this.plots.filter(isShown);
    for (const plot of this.plots) plot.group.toggleAttribute("hidden", !isShown(plot));
    const {columns: most = 1, least = 0, aspect} = this.data;
    const fit = Math.floor(this.width / least);
    const columns = clamp(fit, 1, Math.min(most, this.shown.length || 1));
    const each = Math.min(this.width / columns, aspect ? CHART.widest : Infinity);
    const margins = this.plots.map((plot) => plot.margins(this.width));
    const room = Math.max(...margins.map(({left}) => left));
    const right = Math.max(...margins.map((margin) => margin.right));
    const width = each - room - right;
    const height = this.plots[0].wantedHeight()
      ?? (aspect ? Math.max(aspect * width, CHART.lowest) : this.usualHeight());
    this.shown.forEach((plot, p) => plot.place({left: room + (p % columns) * each, room: room - 4,
      top: CHART.top + Math.floor(p / columns) * (height + CHART.top), width, height,
      lowest: p + columns >= this.shown.length}));
    const rows = Math.ceil(this.shown.length / columns);
    this.height = rows * (height + CHART.top) + CHART.bottom;
    fill(this.svg, {width: this.width, height: this.height});
    fill(this.x_name, {x: room + (columns * each - room - right) / 2, y: this.height - 8});
    this.draw();
  }

  usualHeight() {
    const single = this.plots.length === 1;
    return this.width < CHART.narrow ? (single ? 210 : 150) : (single ? 300 : 180);
  }

  draw() {
    const isHidden = (curve) => this.legend.isHidden(curve);
    for (const plot of this.shown) plot.draw(this.horizontal, isHidden);
    this.svg.dataset.from = this.horizontal.from;
    this.svg.dataset.to = this.horizontal.to;
    this.all.hidden = this.isWhole();
    this.point(null);
  }

  isWhole() {
    return this.horizontal.from === this.whole.from && this.horizontal.to === this.whole.to
      && this.plots.every(({zoomed}) => zoomed === null);
  }

  plotAt({x, y}) {
    return this.shown.find(({box}) => y >= box.top - CHART.top / 2
      && y <= box.top + box.height + CHART.top / 2
      && x >= box.left - box.room && x <= box.left + box.width + CHART.right) ?? null;
  }

  point(at) {
    const plot = at && this.plotAt(at);
    const isHidden = (curve) => this.legend.isHidden(curve);
    const found = plot && (plot.panel.strips ? stripAt(plot, at, this.data.x_label)
      : plot.panel.marks ? markAt(plot, at, isHidden, this.data)
        : valuesAt(plot, at, isHidden, this.data.x_label));
    this.cursor.toggleAttribute("hidden", !found);
    if (!found) {
      this.readout.hide();
      return;
    }
    this.cursor.setAttribute("d", found.outline ?? this.shown.map(({box}, p) =>
      `M${this.shown[p].x(found.value)} ${box.top}v${box.height}`).join(""));
    this.readout.show(found);
  }

  zoom(at, factor) {
    const plot = this.plotAt(at) ?? this.shown[0];
    if (!plot) return;
    const about = plot.sharesOf(at);
    this.show(zoomed(this.horizontal, clamp(about.x, 0, 1), factor),
              this.data.is_map && zoomed(plot.vertical, clamp(about.y, 0, 1), factor));
  }

  move(dx, dy) {
    if (this.shown.length === 0) return;
    const {box, vertical} = this.shown[0];
    const by = -dx / box.width, up = dy / box.height;
    const moved = (axis) => stretch(axis, up, 1 + up);
    if (!this.data.is_map) for (const plot of this.plots) plot.zoomed &&= moved(plot.zoomed);
    this.show(stretch(this.horizontal, by, 1 + by), this.data.is_map && moved(vertical));
  }

  /** All panels of a map show the same place, each other panel its own height. */
  show(horizontal, vertical = null) {
    if (!isWideEnough(horizontal, this.whole)) return;
    this.horizontal = within(horizontal, this.whole);
    if (vertical) {
      for (const plot of this.plots) plot.zoomed = within(vertical, plot.whole);
      if (this.horizontal.from === this.whole.from && this.horizontal.to === this.whole.to) {
        for (const plot of this.plots) plot.zoomed = null;
      }
    }
    this.draw();
  }

  box(from, to) {
    this.drawn_box.toggleAttribute("hidden", !from);
    if (!from) return;
    this.readout.hide();
    fill(this.drawn_box, {x: Math.min(from.x, to.x), y: Math.min(from.y, to.y),
      width: Math.abs(to.x - from.x), height: Math.abs(to.y - from.y)});
  }

  /** A flat box zooms in time alone, a narrow one in height alone; on a map both alike. */
  select(from, to) {
    const plot = this.plotAt({x: (from.x + to.x) / 2, y: (from.y + to.y) / 2});
    if (!plot) return;
    const [a, b] = [plot.sharesOf(from), plot.sharesOf(to)];
    if (this.data.is_map) {
      const half = Math.max(Math.abs(a.x - b.x), Math.abs(a.y - b.y)) / 2;
      const about = (axis, middle) => stretch(axis, middle - half, middle + half);
      this.show(about(this.horizontal, (a.x + b.x) / 2), about(plot.vertical, (a.y + b.y) / 2));
      return;
    }
    const order = (s, t) => [Math.min(s, t), Math.max(s, t)];
    const flat = Math.abs(to.y - from.y) < 24, narrow = Math.abs(to.x - from.x) < 24;
    if (!flat && !plot.panel.strips && !plot.panel.names) {
      plot.zoomed = stretch(plot.vertical, ...order(clamp(a.y, 0, 1), clamp(b.y, 0, 1)));
    }
    this.show(narrow && !flat ? this.horizontal : stretch(this.horizontal, ...order(a.x, b.x)));
  }

  reset() {
    for (const plot of this.plots) plot.zoomed = null;
    this.show(this.whole);
  }
}

/** The first curve or mark of each cell, over all panels: a sample for its button. */
function cellsOf(data) {
  const cells = new Map();
  for (const {names, curves, marks = []} of data.panels) {
    if (names) continue;  // the axis has them
    for (const one of [...curves, ...marks]) {
      if (one.legend && !cells.has(one.legend)) cells.set(one.legend, one);
    }
  }
  return [...cells.values()];
}

function bandsOf(data) {
  return data.panels[0].bands.filter((band) => band.legend);
}
