// SPDX-License-Identifier: BSD-3-Clause
// Which cells are hidden, and the buttons that say so.

/** A set of hidden cells that tells its listeners when it changes. */
class HiddenCells {
  constructor(cells = []) {
    this.cells = new Set(cells);
    this.listeners = [];
  }

  has(cell) {
    return this.cells.has(cell);
  }

  toggle(cell) {
    if (!this.cells.delete(cell)) this.cells.add(cell);
    this.tell();
  }

  /** Hides all others; shows all where they are hidden already. */
  isolate(cell, all) {
    const others = all.filter((other) => other !== cell);
    const alone = !this.has(cell) && others.every((other) => this.has(other));
    for (const other of all) this.cells.delete(other);
    if (!alone) for (const other of others) this.cells.add(other);
    this.tell();
  }

  tell() {
    for (const listener of this.listeners) listener();
  }
}

/** A cell is mostly wanted or not wanted on the whole page. */
const hiddenEverywhere = new HiddenCells();

class Legend {
  /** @param curves one for each cell. @param changed called when something is hidden or shown. */
  constructor(curves, bands, parent, changed) {
    this.curves = curves;
    this.changed = changed;
    this.hidden = hiddenEverywhere;
    hiddenEverywhere.listeners.push(() => this.hidden === hiddenEverywhere && this.update());
    this.element = htmlElement("div", {class: "legend"}, parent);
    this.buttons = curves.map((curve) => this.addButton(curve));
    for (const band of bands) this.addBand(band);
    if (curves.length > 1) this.addLink();
  }

  isHidden(curve) {
    return this.hidden.has(curve.legend);
  }

  addButton(curve) {
    const button = htmlElement("button", {type: "button",
      "aria-pressed": String(!this.isHidden(curve)), "data-cell": curve.legend,
      title: "Hide or show; with Shift: this one alone"}, this.element);
    const sample = svgElement("svg", {width: 26, height: 10, "aria-hidden": "true"}, button);
    svgElement("path", {class: "curve", d: "M1 5H25", ...lineStyle(curve)}, sample);
    button.append(curve.legend);
    button.addEventListener("click", (event) => this.pressed(curve, event));
    return button;
  }

  pressed(curve, event) {
    if (event.shiftKey) this.hidden.isolate(curve.legend, this.curves.map((one) => one.legend));
    else this.hidden.toggle(curve.legend);
    if (this.hidden !== hiddenEverywhere) this.update();
  }

  addBand(band) {
    const entry = htmlElement("span", {class: "entry"}, this.element);
    const sample = svgElement("svg", {width: 26, height: 10, "aria-hidden": "true"}, entry);
    svgElement("rect", {class: "band", width: 26, height: 10}, sample);
    entry.append(band.legend);
  }

  /** Toggles count for the whole page; without the tick for this figure alone. */
  addLink() {
    const label = htmlElement("label", {class: "entry"}, this.element);
    const box = htmlElement("input", {type: "checkbox"}, label);
    box.checked = true;
    label.append("a name hides its filter in all figures");
    box.addEventListener("change", () => {
      this.hidden = box.checked ? hiddenEverywhere : new HiddenCells(hiddenEverywhere.cells);
      this.update();
    });
  }

  update() {
    this.buttons.forEach((button, i) =>
      button.setAttribute("aria-pressed", String(!this.isHidden(this.curves[i]))));
    this.changed();
  }
}
