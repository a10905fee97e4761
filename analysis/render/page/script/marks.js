// SPDX-License-Identifier: BSD-3-Clause
// Marks of a panel at places of their own: lines, points, crosses, ellipses.

const REACH = 40;  // [px] how far from a mark the pointer still means it

const px = (value) => value.toFixed(1);

/** What is no number has no place. */
function placesOf({x, y}) {
  return x.map((_, i) => i).filter((i) => x[i] !== null && y[i] !== null);
}

const SHAPES = {
  line(marks, plot, parent) {
    let path = "";
    marks.x.forEach((x, i) => {
      if (x === null || marks.y[i] === null) return;
      const goes_on = i > 0 && marks.x[i - 1] !== null && marks.y[i - 1] !== null;
      path += `${goes_on ? "L" : "M"}${px(plot.x(x))} ${px(plot.y(marks.y[i]))}`;
    });
    svgElement("path", {class: marks.thickness ? "curve behind" : "curve", d: path,
      ...lineStyle(marks),
      ...(marks.thickness ? {style: `stroke-width: ${marks.thickness}`} : {})}, parent);
  },

  points(marks, plot, parent) {
    const at = (i) => `M${px(plot.x(marks.x[i]))} ${px(plot.y(marks.y[i]))}h0`;
    svgElement("path", {class: "curve dots", d: placesOf(marks).map(at).join(""),
      stroke: lineStyle(marks).stroke,
      ...(marks.thickness ? {style: `stroke-width: ${marks.thickness}`} : {})}, parent);
  },

  crosses(marks, plot, parent) {
    const at = (i) => `M${px(plot.x(marks.x[i]) - 3)} ${px(plot.y(marks.y[i]))}h6m-3 -3v6`;
    svgElement("path", {class: "curve", d: placesOf(marks).map(at).join(""),
      stroke: lineStyle(marks).stroke, style: "stroke-width: 1"}, parent);
  },

  ellipses(marks, plot, parent) {
    for (const i of placesOf(marks)) {
      const [x, y] = [px(plot.x(marks.x[i])), px(plot.y(marks.y[i]))];
      const radius = marks.width[i] / 2;
      const across = Math.max((plot.x(marks.x[i] + radius) - plot.x(marks.x[i] - radius)) / 2, 1);
      const ratio = marks.width[i] > 0 ? marks.height[i] / marks.width[i] : 1;
      svgElement("ellipse", {class: "curve", cx: x, cy: y, rx: px(across),
        ry: px(Math.max(across * ratio, 1)), transform: `rotate(${px(-marks.angle[i])} ${x} ${y})`,
        stroke: lineStyle(marks).stroke, style: "stroke-width: 1"}, parent);
    }
  },
};

function drawMarks(marks, plot, parent) {
  SHAPES[marks.shape](marks, plot, svgElement("g", {class: "marks", "data-cell": marks.legend},
                                              parent));
}

/** The mark nearest to a place, as {i, x, y, distance}, all in pixels but i. */
const NEAREST = {
  /** Between two corners the nearer one speaks. */
  line(marks, plot, at) {
    let best = null;
    const places = placesOf(marks);
    places.forEach((i, k) => {
      const next = places[k + 1] === i + 1 ? i + 1 : i;
      const [x, y] = [plot.x(marks.x[i]), plot.y(marks.y[i])];
      const [dx, dy] = [plot.x(marks.x[next]) - x, plot.y(marks.y[next]) - y];
      const along = ((at.x - x) * dx + (at.y - y) * dy) / (dx * dx + dy * dy || 1);
      const part = clamp(along, 0, 1);
      const foot = {i: part < 0.5 ? i : next, x: x + part * dx, y: y + part * dy};
      foot.distance = Math.hypot(at.x - foot.x, at.y - foot.y);
      if (!best || foot.distance < best.distance) best = foot;
    });
    return best;
  },

  points(marks, plot, at) {
    let best = null;
    for (const i of placesOf(marks)) {
      const [x, y] = [plot.x(marks.x[i]), plot.y(marks.y[i])];
      const distance = Math.hypot(at.x - x, at.y - y);
      if (!best || distance < best.distance) best = {i, x, y, distance};
    }
    return best;
  },
};
NEAREST.crosses = NEAREST.points;
NEAREST.ellipses = NEAREST.points;

/** What the mark at the pointer says; null where there is none. */
function markAt(plot, at, isHidden, {is_map, x_label}) {
  let best = null;
  for (const marks of plot.panel.marks) {
    if (isHidden(marks) || (marks.facts.length === 0 && !is_map)) continue;
    const found = NEAREST[marks.shape](marks, plot, at);
    if (found && found.distance < (best?.distance ?? REACH)) best = {...found, marks};
  }
  if (!best) return null;
  const {marks, i, x, y} = best;
  const row = (label, value) => {
    const [name, text] = nameAndText(label, value, 4);
    return {name, text};
  };
  const places = is_map
    ? [row(x_label, marks.x[i]), row(x_label.replace("x", "y"), marks.y[i])] : [];
  const rows = [...places, ...marks.facts.filter(({values}) => values[i] !== null)
    .map(({label, values}) => row(label, values[i]))];
  const outline = `M${px(x - 6)} ${px(y)}a6 6 0 1 0 12 0a6 6 0 1 0 -12 0`;
  return {title: [marks.legend, marks.name].filter(Boolean).join(": "), rows, outline, x, y};
}
