// SPDX-License-Identifier: BSD-3-Clause
// Draws one moment of a run.

class Scene {
  constructor(canvas, replay, camera) {
    this.canvas = canvas;
    this.replay = replay;
    this.camera = camera;
    this.pen = canvas.getContext("2d");
  }

  /** Colours of the page, light or dark. */
  colours() {
    const style = getComputedStyle(this.canvas);
    const [text, line, page] = ["--text", "--line", "--page"].map((name) =>
      style.getPropertyValue(name).trim());
    return {text, line, page, truth: "#999999"};
  }

  draw(cell, f, layers) {
    this.colour = this.colours();
    const sharp = devicePixelRatio || 1;
    this.pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    this.pen.clearRect(0, 0, this.camera.width, this.camera.height);
    this.drawSurroundings(layers);
    if (layers.map) this.drawEllipses(cell.mapAt(f), cell.data.colour, 1);
    if (layers.truth) this.drawPath(this.replay.truth, f, this.colour.truth, 3);
    if (layers.ancestry) this.drawLineages(cell, f);
    this.drawPath(cell.data, Math.min(f, cell.end - 1), cell.data.colour, 1.6);
    if (layers.particles) this.drawCloud(cell, f);
    this.drawPresent(cell, f, layers);
    this.drawScale();
  }

  line(colour, width, alpha = 1) {
    this.pen.strokeStyle = colour;
    this.pen.fillStyle = colour;
    this.pen.lineWidth = width;
    this.pen.globalAlpha = alpha;
  }

  drawSurroundings(layers) {
    const {camera, pen} = this;
    const {truth, landmarks, fixes} = this.replay;
    if (layers.truth) this.drawPath(truth, truth.x.length - 1, this.colour.line, 1);
    this.line(this.colour.truth, 1, 0.7);
    for (let k = 0; k < fixes.length; k += 2) {
      pen.fillRect(camera.x(fixes[k]) - 1, camera.y(fixes[k + 1]) - 1, 2, 2);
    }
    this.line(this.colour.text, 1, 0.8);
    pen.beginPath();
    for (let k = 0; k < landmarks.length; k += 2) {
      const x = camera.x(landmarks[k]), y = camera.y(landmarks[k + 1]);
      pen.moveTo(x - 3, y);
      pen.lineTo(x + 3, y);
      pen.moveTo(x, y - 3);
      pen.lineTo(x, y + 3);
    }
    pen.stroke();
  }

  drawPath({x, y}, last, colour, width) {
    this.line(colour, width);
    this.pen.beginPath();
    for (let f = 0; f <= last && f < x.length; ++f) {
      if (x[f] !== null) this.pen.lineTo(this.camera.x(x[f]), this.camera.y(y[f]));
    }
    this.pen.stroke();
  }

  drawLineages(cell, f) {
    const {camera, pen} = this;
    this.line(cell.data.colour, 0.8, 0.45);
    pen.beginPath();
    for (const [from, to] of cell.lineagesAt(f)) {
      pen.moveTo(camera.x(from[0]), camera.y(from[1]));
      pen.lineTo(camera.x(to[0]), camera.y(to[1]));
    }
    pen.stroke();
  }

  drawCloud(cell, f) {
    const {camera, pen} = this;
    this.line(cell.data.colour, 1, 0.7);
    pen.beginPath();
    for (const [x, y] of cell.cloudAt(f)) {
      pen.moveTo(camera.x(x) + 1.8, camera.y(y));
      pen.arc(camera.x(x), camera.y(y), 1.8, 0, 2 * Math.PI);
    }
    pen.fill();
  }

  drawEllipses(ellipses, colour, width) {
    const {camera, pen} = this;
    this.line(colour, width);
    for (const {x, y, major, minor, angle} of ellipses) {
      if (major === null || minor === null) continue;
      pen.beginPath();
      pen.ellipse(camera.x(x), camera.y(y), Math.max(major * camera.scale / 2, 1),
                  Math.max(minor * camera.scale / 2, 1), -angle * Math.PI / 180, 0, 2 * Math.PI);
      pen.stroke();
    }
  }

  drawPresent(cell, f, layers) {
    const {x, y, h} = this.replay.truth;
    if (layers.truth && x.length > 0) {
      this.drawVehicle({x: x[f], y: y[f], heading: h[f]}, this.colour.truth);
    }
    const pose = cell.poseAt(f), ellipse = cell.ellipseAt(f);
    if (pose) this.drawVehicle(pose, cell.data.colour);
    if (ellipse && layers.ellipse) this.drawEllipses([ellipse], this.colour.text, 1.4);
  }

  /** An arrow head of fixed size, whatever the zoom, so that it is always seen. */
  drawVehicle({x, y, heading}, colour) {
    const {camera, pen} = this;
    this.line(colour, 1.2);
    pen.save();
    pen.translate(camera.x(x), camera.y(y));
    pen.rotate(-heading);
    pen.beginPath();
    pen.moveTo(10, 0);
    pen.lineTo(-7, 6);
    pen.lineTo(-3, 0);
    pen.lineTo(-7, -6);
    pen.closePath();
    pen.fill();
    pen.strokeStyle = this.colour.page;
    pen.stroke();
    pen.restore();
  }

  /** A bar of a round number of metres. */
  drawScale() {
    const {camera, pen} = this;
    const metres = niceDistance(camera.width / camera.scale, 9);
    const left = 10, y = camera.height - 12, length = metres * camera.scale;
    this.line(this.colour.text, 1);
    pen.beginPath();
    pen.moveTo(left, y - 4);
    pen.lineTo(left, y);
    pen.lineTo(left + length, y);
    pen.lineTo(left + length, y - 4);
    pen.stroke();
    pen.font = "12px system-ui, sans-serif";
    pen.fillText(`${readable(metres)} m`, left + 4, y - 5);
  }
}
