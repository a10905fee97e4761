// SPDX-License-Identifier: BSD-3-Clause
// Plays a stored run, cell beside cell: buttons, keys and the one clock of them all.

const WANTED_SECONDS = 30;  // that a run takes to play unless told otherwise
const MOST_PANELS = 4;

class Player {
  constructor(parent, replay) {
    parent.classList.add("has-live");
    this.replay = replay;
    this.cells = replay.cells.map((data) => new ReplayedCell(data));
    this.camera = new Camera(boundsOf(replay));
    this.frame = replay.times.length - 1;  // all of the run is seen; playing begins anew
    this.playing = false;
    const live = htmlElement("div", {class: "live"}, parent);
    this.addControls(htmlElement("div", {class: "controls"}, live));
    this.addPanels(live);
    this.addLayers(htmlElement("div", {class: "layers"}, live));
    htmlElement("div", {class: "hint", text: handsSay("Drag a map to move it, Ctrl and wheel to "
      + "zoom; a double click shows all. Space plays, arrow keys step.",
    "Two fingers move and zoom a map; a double tap shows all.")}, live);
    live.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.layOut()).observe(live);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    this.show(this.panels.slice(0, MOST_PANELS));
  }

  addControls(bar) {
    this.button = htmlElement("button", {type: "button", class: "play"}, bar);
    this.button.addEventListener("click", () => this.toggle());
    this.slider = htmlElement("input", {type: "range", min: 0, step: 1, value: 0,
      max: this.replay.times.length - 1, "aria-label": "time"}, bar);
    this.slider.addEventListener("input", () => this.seek(Number(this.slider.value)));
    this.clock = htmlElement("output", {class: "clock"}, bar);
    this.addSpeeds(bar);
  }

  /** Speeds are multiples of real time; the run takes about half a minute at first. */
  addSpeeds(bar) {
    const {times} = this.replay;
    const natural = Math.max((times.at(-1) - times[0]) / WANTED_SECONDS, 0.1);
    const power = 10 ** Math.floor(Math.log10(natural));
    const first = [1, 2, 5, 10].map((step) => step * power).find((step) => step >= natural * 0.99);
    this.pace = htmlElement("select", {"aria-label": "speed"}, bar);
    for (const speed of [first / 10, first / 4, first / 2, first, 2 * first, 4 * first]) {
      htmlElement("option", {value: speed, text: `${readable(speed)} × real time`}, this.pace);
    }
    this.pace.value = String(first);
  }

  addPanels(parent) {
    const axis = this.cells.some((cell) => cell.hasNees) ? neesAxis(this.cells) : null;
    const panels = htmlElement("div", {class: "panels"}, parent);
    this.chooser = htmlElement("div", {class: "legend", role: "group", "aria-label": "cells"});
    this.panels = this.cells.map((cell) => {
      const panel = new ReplayPanel(panels, cell, this.replay, this.camera, axis);
      new Gestures(panel.canvas, this, "move");
      panel.button = this.addChoice(panel);
      return panel;
    });
    this.chooser.hidden = this.panels.length < 2;
  }

  addChoice(panel) {
    const {label, failure, colour} = panel.cell.data;
    const button = htmlElement("button", {type: "button", "data-cell": label,
      text: failure ? `${label} (failed)` : label}, this.chooser);
    button.style.borderColor = colour;
    button.addEventListener("click", () => this.choose(panel));
    return button;
  }

  /** Shows a cell, in place of the one that was chosen first where there are too many; or hides
   *  it, unless it is the last. */
  choose(panel) {
    const others = this.shown.filter((one) => one !== panel);
    if (others.length === this.shown.length) this.show([...others, panel].slice(-MOST_PANELS));
    else if (others.length > 0) this.show(others);
  }

  show(panels) {
    this.shown = panels;
    for (const panel of this.panels) {
      panel.element.hidden = !panels.includes(panel);
      panel.button.setAttribute("aria-pressed", String(!panel.element.hidden));
    }
    this.width = null;
    this.layOut();
  }

  /** What can be shown or left out: cells, and what the file holds of any of them. */
  addLayers(bar) {
    bar.append(this.chooser);
    const {cells, replay} = this;
    const names = {
      truth: replay.truth.x.length > 0 && "true path",
      ellipse: cells.some(({data}) => data.pose.length > 0) && "95 % of the position",
      particles: cells.some((cell) => cell.hasParticles) && "particles",
      ancestry: cells.some((cell) => cell.hasParticles && cell.data.ancestry) && "ancestry",
      map: cells.some(({data}) => data.maps.length > 0) && "map, 95 % of each landmark",
      follow: "follow the vehicle",
    };
    this.layers = {};
    for (const [name, words] of Object.entries(names)) {
      this.layers[name] = Boolean(words) && name !== "follow";
      if (words) this.addLayer(name, words, bar);
    }
  }

  addLayer(name, words, bar) {
    const label = htmlElement("label", {}, bar);
    const box = htmlElement("input", {type: "checkbox", name}, label);
    box.checked = this.layers[name];
    label.append(words);
    box.addEventListener("change", () => {
      this.layers[name] = box.checked;
      if (name === "follow") this.follow();
      this.draw();
    });
  }

  /** Following means nearer, too: a tenth of the world. */
  follow() {
    this.camera.reset();
    if (this.layers.follow) this.camera.zoom_factor = 10;
  }

  layOut() {
    const width = this.slider.parentElement.clientWidth;
    if (width === this.width || width === 0) return;
    this.width = width;
    for (const panel of this.shown) panel.layOut();
    this.draw();
  }

  /** Where all cameras look that follow: at the vehicle, or else where the first cell takes it. */
  here() {
    const {truth} = this.replay;
    if (truth.x.length > 0) return {x: truth.x[this.frame], y: truth.y[this.frame]};
    return this.shown[0].cell.poseAt(this.frame);
  }

  draw() {
    if (!this.camera.width) return;
    const {times} = this.replay;
    const here = this.here();
    if (this.layers.follow && here) this.camera.centre = here;
    for (const panel of this.shown) panel.draw(this.frame, this.layers);
    this.slider.value = String(this.frame);
    this.clock.textContent = `${times[this.frame].toFixed(1)} s of ${times.at(-1).toFixed(1)} s`;
    this.button.textContent = this.playing ? "Pause" : "Play";
  }

  seek(frame) {
    this.frame = clamp(frame, 0, this.replay.times.length - 1);
    this.time = this.replay.times[this.frame];
    this.draw();
  }

  toggle() {
    this.playing = !this.playing;
    if (this.playing) {
      if (this.frame === this.replay.times.length - 1) this.frame = 0;
      this.time = this.replay.times[this.frame];
      this.last = performance.now();
      requestAnimationFrame((now) => this.tick(now));
    }
    this.draw();
  }

  tick(now) {
    if (!this.playing) return;
    const {times} = this.replay;
    this.time += Math.max(now - this.last, 0) / 1000 * Number(this.pace.value);
    this.last = now;
    const frame = Math.min(firstFrom(times, this.time + 1e-9), times.length) - 1;
    if (frame === times.length - 1) this.playing = false;
    if (frame > this.frame || !this.playing) {
      this.frame = Math.max(frame, this.frame);
      this.draw();
    }
    requestAnimationFrame((next) => this.tick(next));
  }

  /** Space plays, arrows step, on a picture and the slider; elsewhere keys mean what they do. */
  key(event) {
    if (!event.target.matches(".scene") && event.target !== this.slider) return;
    const many = event.shiftKey ? 10 : 1;
    const actions = {
      " ": () => this.toggle(),
      ArrowLeft: () => this.seek(this.frame - many),
      ArrowRight: () => this.seek(this.frame + many),
      Home: () => this.seek(0),
      End: () => this.seek(this.replay.times.length - 1),
    };
    if (!(event.key in actions) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    actions[event.key]();
  }

  // What Gestures tells: the picture is moved and zoomed like a map.

  point() {}

  move(dx, dy) {
    if (this.layers.follow) return;
    this.camera.move(dx, dy);
    this.draw();
  }

  zoom(at, factor) {
    this.camera.zoom(at.x, at.y, factor);
    this.draw();
  }

  reset() {
    this.follow();
    this.draw();
  }
}
