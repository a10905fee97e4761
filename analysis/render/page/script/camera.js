// SPDX-License-Identifier: BSD-3-Clause
// From metres to pixels of a canvas: one scale in both directions, y upwards.

class Camera {
  constructor(bounds) {
    this.bounds = bounds;
    this.zoom_factor = 1;
    this.centre = null;
  }

  resize(width, height) {
    this.width = width;
    this.height = height;
  }

  get whole() {
    const {left, right, low, high} = this.bounds;
    return {x: (left + right) / 2, y: (low + high) / 2};
  }

  /** Pixels a metre. */
  get scale() {
    const {left, right, low, high} = this.bounds;
    const room = 0.92;
    return this.zoom_factor * Math.min(this.width * room / Math.max(right - left, 1e-3),
                                       this.height * room / Math.max(high - low, 1e-3));
  }

  /** Height over width at which everything fits. */
  static aspect({left, right, low, high}) {
    return (high - low) / Math.max(right - left, 1e-3);
  }

  x(metres) {
    return this.width / 2 + (metres - (this.centre ?? this.whole).x) * this.scale;
  }

  y(metres) {
    return this.height / 2 - (metres - (this.centre ?? this.whole).y) * this.scale;
  }

  reset() {
    this.zoom_factor = 1;
    this.centre = null;
  }

  move(dx, dy) {
    const {x, y} = this.centre ?? this.whole;
    this.centre = {x: x - dx / this.scale, y: y + dy / this.scale};
  }

  /** Nearer (factor < 1) or farther, with what is at (px, py) staying there. */
  zoom(px, py, factor) {
    const away = {x: px - this.width / 2, y: py - this.height / 2};
    this.move(-away.x, -away.y);
    this.zoom_factor = clamp(this.zoom_factor / factor, 0.5, 400);
    this.move(away.x, away.y);
  }
}
