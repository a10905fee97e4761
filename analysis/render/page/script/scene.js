// SPDX-License-Identifier: BSD-3-Clause
// Draws one moment of a run on a canvas.

/** A canvas for sharp drawings of any size, in pixels of the page. */
class Paper {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
  }

  resize(width, height) {
    const sharp = devicePixelRatio || 1;
    fill(this.canvas, {width: Math.round(width * sharp), height: Math.round(height * sharp)});
    this.canvas.style.height = `${height}px`;
    Object.assign(this, {width, height});
  }

  /** Empty again, in the colours of the page, light or dark. */
  clear() {
    const style = getComputedStyle(this.canvas);
    const [text, soft, line, page] = ["--text", "--soft", "--line", "--page"].map((name) =>
      style.getPropertyValue(name).trim());
    this.colour = {text, soft, line, page, truth: "#999999"};
    const sharp = devicePixelRatio || 1;
    this.pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    this.pen.clearRect(0, 0, this.width, this.height);
    this.pen.lineJoin = "round";
  }

  line(colour, width, alpha = 1) {
    this.pen.strokeStyle = colour;
    this.pen.fillStyle = colour;
    this.pen.lineWidth = width;
    this.pen.globalAlpha = alpha;
  }
}

class Scene {
  /** `size` of vehicles, dots and lines, by the usual. */
  constructor(canvas, replay, camera, size = 1) {
    this.paper = new Paper(canvas);
    this.pen = this.paper.pen;
    this.replay = replay;
    this.camera = camera;
    this.size = size;
  }

  draw(cell, f, layers) {
    this.paper.clear();
    this.drawSurroundings(layers);
    if (layers.map) this.drawEllipses(cell.mapAt(f), cell.data.colour);
    if (layers.truth) this.drawPath(this.replay.truth, f, this.paper.colour.truth, 2.4, 0.75);
    if (layers.ancestry) this.drawLineages(cell, f);
    this.drawPath(cell.data, Math.min(f, cell.end - 1), cell.data.colour, 1.3);
    const ellipse = layers.ellipse && cell.ellipseAt(f);
    if (ellipse) this.drawEllipses([ellipse], cell.data.colour);
    if (layers.particles) this.drawCloud(cell, f);
    this.drawVehicles(cell, f, layers);
    this.drawScale();
  }

  drawSurroundings(layers) {
    const {camera, pen, paper} = this;
    const {truth, landmarks, fixes} = this.replay;
    if (layers.truth) this.drawPath(truth, truth.x.length - 1, paper.colour.line, 1);
    paper.line(paper.colour.truth, 1, 0.7);
    for (let k = 0; k < fixes.length; k += 2) {
      pen.fillRect(camera.x(fixes[k]) - 1, camera.y(fixes[k + 1]) - 1, 2, 2);
    }
    paper.line(paper.colour.text, 1, 0.55);
    pen.beginPath();
    for (let k = 0; k < landmarks.length; k += 2) {
      const x = camera.x(landmarks[k]), y = camera.y(landmarks[k + 1]);
      pen.moveTo(x - 2.5, y);
      pen.lineTo(x + 2.5, y);
      pen.moveTo(x, y - 2.5);
      pen.lineTo(x, y + 2.5);
    }
    pen.stroke();
  }

  drawPath({x, y}, last, colour, width, alpha = 1) {
    this.paper.line(colour, width * this.size, alpha);
    this.pen.beginPath();
    for (let f = 0; f <= last && f < x.length; ++f) {
      if (x[f] !== null) this.pen.lineTo(this.camera.x(x[f]), this.camera.y(y[f]));
    }
    this.pen.stroke();
  }

  drawLineages(cell, f) {
    const {camera, pen} = this;
    this.paper.line(cell.data.colour, 0.6, 0.4);
    pen.beginPath();
    for (const [from, to] of cell.lineagesAt(f)) {
      pen.moveTo(camera.x(from[0]), camera.y(from[1]));
      pen.lineTo(camera.x(to[0]), camera.y(to[1]));
    }
    pen.stroke();
  }

  drawCloud(cell, f) {
    if (!cell.hasParticles) return;
    const {camera, pen} = this;
    const darkness = cell.darknessAt(f);
    this.paper.line(cell.data.colour, 1);
    cell.cloudAt(f).forEach(([x, y], i) => {
      pen.globalAlpha = 0.1 + 0.7 * darkness(i);
      pen.beginPath();
      pen.arc(camera.x(x), camera.y(y), 1.6 * this.size, 0, 2 * Math.PI);
      pen.fill();
    });
  }

  /** Filled faintly, so that many are seen as many; never too small to be seen. */
  drawEllipses(ellipses, colour) {
    const {camera, pen} = this;
    for (const {x, y, major, minor, angle} of ellipses) {
      if (major === null || minor === null) continue;
      pen.beginPath();
      pen.ellipse(camera.x(x), camera.y(y), Math.max(major * camera.scale / 2, 1.5),
                  Math.max(minor * camera.scale / 2, 1.5), -angle * Math.PI / 180, 0, 2 * Math.PI);
      this.paper.line(colour, 1.1, 0.14);
      pen.fill();
      pen.globalAlpha = 0.9;
      pen.stroke();
    }
  }

  /** The true one hollow, the estimated one full. */
  drawVehicles(cell, f, layers) {
    const {x, y, h} = this.replay.truth;
    const pose = cell.poseAt(f);
    if (pose) this.drawVehicle(pose, cell.data.colour, () => this.pen.fill());
    if (!layers.truth || x.length === 0) return;
    this.drawVehicle({x: x[f], y: y[f], heading: h[f]}, this.paper.colour.text,
                     () => this.pen.stroke());
  }

  /** An arrow head of fixed size, whatever the zoom, so that it is always seen. */
  drawVehicle({x, y, heading}, colour, finish) {
    const {camera, pen} = this;
    this.paper.line(colour, 1.3);
    pen.save();
    pen.translate(camera.x(x), camera.y(y));
    pen.rotate(-heading);
    pen.beginPath();
    pen.moveTo(9, 0);
    pen.lineTo(-6, 5);
    pen.lineTo(-3, 0);
    pen.lineTo(-6, -5);
    pen.closePath();
    finish();
    pen.restore();
  }

  /** A bar of a round number of metres, on the colour of the page. */
  drawScale() {
    const {camera, pen, paper} = this;
    const metres = niceDistance(camera.width / camera.scale, 9);
    const left = 8, y = camera.height - 8, length = metres * camera.scale;
    const text = `${readable(metres)} m`;
    pen.font = "11px system-ui, sans-serif";
    pen.textAlign = "left";
    paper.line(paper.colour.page, 1, 0.85);
    pen.fillRect(left - 4, y - 16, Math.max(length, 4 + pen.measureText(text).width) + 8, 20);
    paper.line(paper.colour.soft, 1);
    pen.beginPath();
    pen.moveTo(left, y - 3);
    pen.lineTo(left, y);
    pen.lineTo(left + length, y);
    pen.lineTo(left + length, y - 3);
    pen.stroke();
    pen.fillText(text, left + 4, y - 4);
  }
}
