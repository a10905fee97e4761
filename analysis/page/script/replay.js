// SPDX-License-Identifier: BSD-3-Clause
// What a stored run says about any moment of it.

/** A cell of a replayed run: the page's numbers as things to draw, in metres and radians. */
class ReplayedCell {
  constructor(data) {
    this.data = data;
    this.frames = data.x.length;
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
    return this.data.clouds.length > 0;
  }

  /** Particles as [[x, y], ...]. */
  cloudAt(f) {
    const {clouds, unit} = this.data;
    const centre = this.poseAt(f);
    if (!centre || !clouds[f]) return [];
    return clouds[f].x.map((dx, i) => [centre.x + unit * dx, centre.y + unit * clouds[f].y[i]]);
  }

  /** The ways of the present particles' ancestors: [[from, to], ...], each way once. */
  lineagesAt(f) {
    const ways = [];
    let alive = this.cloudAt(f).map((_, i) => i);
    let cloud = this.cloudAt(f);
    for (; f > 0 && alive.length > 0; --f) {
      const {parent} = this.data.clouds[f];
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
      const {parent} = this.data.clouds[f];
      if (!parent) return null;
      alive = [...new Set(alive.map((i) => parent[i]))];
    }
    return alive.length;
  }

  /** The last map not later than frame `f`, as ellipses. */
  mapAt(f) {
    const map = this.data.maps.findLast(({frame}) => frame <= f);
    if (!map) return [];
    const ellipses = [];
    for (let k = 0; k < map.landmarks.length; k += 5) {
      const [x, y, major, minor, angle] = map.landmarks.slice(k, k + 5);
      ellipses.push({x, y, major, minor, angle});
    }
    return ellipses;
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
