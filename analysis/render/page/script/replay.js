// SPDX-License-Identifier: BSD-3-Clause
// What a stored run says about any moment of it.

const DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz-_";

/** A number of base 64. */
function numberOf(digits) {
  return [...digits].reduce((number, digit) => 64 * number + DIGITS.indexOf(digit), 0);
}

/** Metres from the estimate; 0 stands for what is no number. */
function offset(digits, size) {
  const number = numberOf(digits);
  return number === 0 ? NaN : (number - 2048) / 2047 * size;
}

/** A cell of a replayed run: the page's numbers as things to draw, in metres and radians. */
class ReplayedCell {
  constructor(data) {
    this.data = data;
    this.frames = data.x.length;
    this.clouds = data.clouds.map(({size, dots, parent, weight}) => ({
      offsets: dots.match(/..../g).map((digits) => [offset(digits.slice(0, 2), size),
                                                    offset(digits.slice(2), size)]),
      parent: parent?.match(/../g).map(numberOf),
      darkness: weight && [...weight].map((digit) => numberOf(digit) / 63),
    }));
  }

  /** The frames that there are: a failed run ends early. */
  get end() {
    const missing = this.data.x.indexOf(null);
    return missing < 0 ? this.frames : Math.max(missing, 1);
  }

  poseAt(f) {
    const {x, y, h} = this.data;
    return x[f] === null || x[f] === undefined ? null : {x: x[f], y: y[f], heading: h[f]};
  }

  ellipseAt(f) {
    const {pose} = this.data;
    const centre = this.poseAt(f);
    if (!centre || pose.length === 0 || pose[3 * f] === null) return null;
    return {...centre, major: pose[3 * f], minor: pose[3 * f + 1], angle: pose[3 * f + 2]};
  }

  get hasParticles() {
    return this.clouds.length > 0;
  }

  get hasNees() {
    return this.data.nees.length > 0;
  }

  /** Particles as [[x, y], ...]. */
  cloudAt(f) {
    const centre = this.poseAt(f);
    if (!centre || !this.clouds[f]) return [];
    return this.clouds[f].offsets.map(([dx, dy]) => [centre.x + dx, centre.y + dy]);
  }

  /** How dark each particle is drawn, from 0 to 1: the root of its weight by the heaviest's. */
  darknessAt(f) {
    const {darkness} = this.clouds[f];
    return (i) => darkness ? darkness[i] : 1;
  }

  /** The ways of the present particles' ancestors: [[from, to], ...], each way once. */
  lineagesAt(f) {
    const ways = [];
    let alive = this.cloudAt(f).map((_, i) => i);
    let cloud = this.cloudAt(f);
    for (; f > 0 && alive.length > 0; --f) {
      const {parent} = this.clouds[f];
      if (!parent) break;
      const before = this.cloudAt(f - 1);
      for (const i of alive) ways.push([before[parent[i]], cloud[i]]);
      alive = [...new Set(alive.map((i) => parent[i]))];
      cloud = before;
    }
    return ways;
  }

  /** How many ancestors the present particles have `back` frames ago; null where nobody knows. */
  ancestorsAt(f, back) {
    let alive = this.cloudAt(f).map((_, i) => i);
    for (const last = Math.max(f - back, 0); f > last; --f) {
      const {parent} = this.clouds[f];
      if (!parent) return null;
      alive = [...new Set(alive.map((i) => parent[i]))];
    }
    return alive.length;
  }

  /** The map at frame `f`, as ellipses: each landmark as it was when it last changed. */
  mapAt(f) {
    const ellipses = new Map();
    for (const {frame, landmarks} of this.data.maps) {
      if (frame > f) break;
      for (let k = 0; k < landmarks.length; k += 6) {
        const [row, x, y, major, minor, angle] = landmarks.slice(k, k + 6);
        if (x === null) ellipses.delete(row);  // no longer in the map
        else ellipses.set(row, {x, y, major, minor, angle});
      }
    }
    return [...ellipses.values()];
  }
}

/** Everything that is seen lies within. */
function boundsOf(replay) {
  const bounds = {left: Infinity, right: -Infinity, low: Infinity, high: -Infinity};
  const include = (x, y) => {
    if (x === null || y === null) return;
    bounds.left = Math.min(bounds.left, x);
    bounds.right = Math.max(bounds.right, x);
    bounds.low = Math.min(bounds.low, y);
    bounds.high = Math.max(bounds.high, y);
  };
  const {truth, landmarks, fixes, cells} = replay;
  truth.x.forEach((x, f) => include(x, truth.y[f]));
  for (const points of [landmarks, fixes]) {
    for (let k = 0; k < points.length; k += 2) include(points[k], points[k + 1]);
  }
  // A filter that lost its way may be anywhere; it counts only where nothing else is known.
  if (bounds.left === Infinity) {
    for (const {x, y} of cells) x.forEach((value, f) => include(value, y[f]));
  }
  return bounds;
}
