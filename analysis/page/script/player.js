// SPDX-License-Identifier: BSD-3-Clause
// Plays a stored run: buttons, keys and the clock.

const WANTED_SECONDS = 30;  // that a run takes to play unless told otherwise

class Player {
  constructor(parent, replay) {
    this.replay = replay;
    this.cells = replay.cells.map((data) => new ReplayedCell(data));
    this.camera = new Camera(boundsOf(replay));
    this.frame = 0;
    this.playing = false;
    this.addControls(htmlElement("div", {class: "live controls"}, parent));
    this.canvas = htmlElement("canvas", {class: "scene", tabindex: 0, role: "img",
      "aria-label": "The vehicle, what the filter thinks, and the landmarks"}, parent);
    this.addLayers(htmlElement("div", {class: "live layers"}, parent));
    this.scene = new Scene(this.canvas, replay, this.camera);
    new Gestures(this.canvas, this, "move");
    parent.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.layOut()).observe(parent);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    this.choose(0);
    this.layOut();
  }

  addControls(bar) {
    this.button = htmlElement("button", {type: "button", class: "play"}, bar);
    this.button.addEventListener("click", () => this.toggle());
    this.slider = htmlElement("input", {type: "range", min: 0, step: 1, value: 0,
      max: this.replay.times.length - 1, "aria-label": "time"}, bar);
    this.slider.addEventListener("input", () => this.seek(Number(this.slider.value)));
    this.clock = htmlElement("output", {class: "clock"}, bar);
    this.chooser = htmlElement("select", {"aria-label": "cell"}, bar);
    this.cells.forEach(({data}, c) => htmlElement("option", {value: c,
      text: data.failure ? `${data.label} (failed)` : data.label}, this.chooser));
    this.chooser.addEventListener("change", () => this.choose(Number(this.chooser.value)));
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

  /** What can be shown or left out, as far as the file holds it for any cell. */
  addLayers(bar) {
    const {cells, replay} = this;
    const names = {
      truth: replay.truth.x.length > 0 && "true path",
      ellipse: cells.some(({data}) => data.pose.length > 0) && "2 sigma of the position",
      particles: cells.some((cell) => cell.hasParticles) && "particles",
      ancestry: cells.some((cell) => cell.hasParticles && cell.data.ancestry) && "ancestry",
      map: cells.some(({data}) => data.maps.length > 0) && "map",
      follow: "follow the vehicle",
    };
    this.layers = {};
    for (const [name, words] of Object.entries(names)) {
      this.layers[name] = Boolean(words) && name !== "follow";
      if (words) this.addLayer(name, words, bar);
    }
    this.note = htmlElement("span", {class: "soft"}, bar);
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

  choose(c) {
    this.cell = this.cells[c];
    this.draw();
  }

  layOut() {
    const width = this.canvas.parentElement.clientWidth;
    if (width === this.width) return;
    this.width = width;
    const height = clamp(width * Camera.aspect(this.camera.bounds), 240, width < 600 ? 420 : 560);
    const sharp = devicePixelRatio || 1;
    fill(this.canvas, {width: Math.round(width * sharp), height: Math.round(height * sharp)});
    this.canvas.style.height = `${height}px`;
    this.camera.resize(width, height);
    this.draw();
  }

  draw() {
    if (!this.camera.width) return;
    const {times} = this.replay;
    const here = this.cell.poseAt(this.frame);
    if (this.layers.follow && here) this.camera.centre = here;
    this.scene.draw(this.cell, this.frame, this.layers);
    this.slider.value = String(this.frame);
    this.clock.textContent = `${times[this.frame].toFixed(1)} s of ${times.at(-1).toFixed(1)} s`;
    this.button.textContent = this.playing ? "Pause" : "Play";
    this.note.textContent = this.sayMore();
  }

  sayMore() {
    const {data, end} = this.cell;
    if (data.failure && this.frame >= end - 1) return data.failure;
    if (!this.cell.hasParticles) return "";
    const shown = data.clouds[this.frame].x.length;
    const seen = shown < data.particles ? `${shown} of ${data.particles} particles shown` :
      `${shown} particles`;
    const roots = this.cell.ancestorsAt(this.frame, this.frame);
    return roots === null ? seen : `${seen}; at the start they had ${roots} ancestor${
      roots === 1 ? "" : "s"}`;
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

  /** Space plays, arrows step, on the picture and its slider; elsewhere keys mean what they do. */
  key(event) {
    if (event.target !== this.canvas && event.target !== this.slider) return;
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
