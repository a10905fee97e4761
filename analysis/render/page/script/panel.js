// SPDX-License-Identifier: BSD-3-Clause
// What the player shows of one cell: the whole drive, a close-up of the vehicle, and the NEES.

class ReplayPanel {
  constructor(parent, cell, replay, camera, axis) {
    Object.assign(this, {cell, replay, camera});
    this.element = htmlElement("div", {class: "panel", "data-cell": cell.data.label}, parent);
    const head = htmlElement("div", {class: "head"}, this.element);
    this.name = htmlElement("span", {class: "name", text: cell.data.label}, head);
    this.name.style.setProperty("--cell", cell.data.colour);
    this.said = htmlElement("span", {class: "soft"}, head);
    this.canvas = htmlElement("canvas", {class: "scene", tabindex: 0, role: "img",
      "aria-label": `${cell.data.label}: the vehicle, its estimate, and the landmarks`},
      this.element);
    this.scene = new Scene(this.canvas, replay, camera);
    this.lower = htmlElement("div", {class: "lower"}, this.element);
    this.near = new Camera({left: -replay.close_up, right: replay.close_up, low: -replay.close_up,
      high: replay.close_up});
    this.closeUp = new Scene(this.addCanvas("close", "the vehicle, close up"), replay, this.near,
                             1.4);
    if (!axis) return;
    this.growth = new Growth(this.addCanvas("growth", "NEES of the run, with the band of a " +
      "consistent filter"), replay.times, axis);
  }

  addCanvas(name, words) {
    return htmlElement("canvas", {class: name, role: "img",
      "aria-label": `${this.cell.data.label}: ${words}`}, this.lower);
  }

  layOut() {
    const width = this.element.clientWidth;
    const height = Math.round(clamp(width * Camera.aspect(this.camera.bounds), 200, 460));
    this.scene.paper.resize(width, height);
    this.camera.resize(width, height);
    const side = Math.round(clamp(width * 0.32, 96, 150));
    this.closeUp.paper.canvas.style.width = `${side}px`;
    this.closeUp.paper.resize(side, side);
    this.near.resize(side, side);
    if (this.growth) this.growth.paper.resize(this.growth.paper.canvas.clientWidth, side);
  }

  draw(f, layers) {
    const {truth} = this.replay;
    this.scene.draw(this.cell, f, layers);
    this.near.centre = truth.x.length > 0 ? {x: truth.x[f], y: truth.y[f]} :
      this.cell.poseAt(f) ?? this.near.centre;
    this.closeUp.draw(this.cell, f, layers);
    if (this.growth) this.growth.draw(this.cell, f);
    this.said.textContent = this.say(f);
    this.name.title = this.sayMore(f);
  }

  /** The NEES now, or why there is none any more. */
  say(f) {
    const {data, end} = this.cell;
    if (data.failure && f >= end - 1) return data.failure;
    return this.cell.hasNees ? `this run: NEES ratio ${readable(data.nees[f], 3)}` : "";
  }

  sayMore(f) {
    if (!this.cell.hasParticles) return "";
    const {data} = this.cell;
    const shown = this.cell.clouds[f].offsets.length;
    const seen = shown < data.particles ? `${shown} of ${data.particles} particles shown` :
      `${shown} particles`;
    const roots = this.cell.ancestorsAt(f, f);
    return roots === null ? seen : `${seen}; at the start they had ${roots} ancestor${
      roots === 1 ? "" : "s"}`;
  }
}
