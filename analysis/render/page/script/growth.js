// SPDX-License-Identifier: BSD-3-Clause
// The NEES of a run as it grows, with the band of a consistent filter.

const LEAST_NEES = 0.1, MOST_NEES = 1e6;

/** One axis for all cells. */
function neesAxis(cells) {
  const known = cells.flatMap(({data}) => data.nees).filter(Number.isFinite);
  const greatest = Math.max(20, ...cells.map(({data}) => 2 * data.band[1]),
                            ...known.map((value) => 1.3 * value));
  return {logarithmic: true, from: LEAST_NEES, to: Math.min(greatest, MOST_NEES)};
}

class Growth {
  constructor(canvas, times, axis) {
    this.paper = new Paper(canvas);
    this.times = times;
    this.axis = axis;
  }

  x(time) {
    const {times, paper} = this;
    return 34 + (time - times[0]) / Math.max(times.at(-1) - times[0], 1e-9) * (paper.width - 42);
  }

  /** What is less than the axis shows lies on it. */
  y(value) {
    const share = clamp(shareOf(this.axis, Math.max(value, LEAST_NEES)), 0, 1);
    return 6 + (1 - share) * (this.paper.height - 28);
  }

  draw(cell, f) {
    const {paper, axis} = this;
    paper.clear();
    const {pen, width} = paper;
    const [low, high] = cell.data.band;
    paper.line("#808080", 1, 0.22);
    pen.fillRect(34, this.y(high), width - 42, this.y(low) - this.y(high));
    pen.font = "11px system-ui, sans-serif";
    pen.textAlign = "right";
    const decades = Math.log10(axis.to / axis.from);
    const step = decades < 4 ? 1 : 2;
    for (let power = -1; power <= decades - 1; power += step) this.drawTick(power);
    this.drawTimes();
    this.drawCurve(cell, f);
  }

  drawTick(power) {
    const {pen, colour, width} = this.paper;
    const tick = 10 ** power;
    this.paper.line(colour.line, 1);
    pen.fillRect(34, this.y(tick), width - 42, 0.6);
    this.paper.line(colour.soft, 1);
    const text = power < 3 ? readable(tick) : `10${"⁰¹²³⁴⁵⁶"[power]}`;
    pen.fillText(text, 29, this.y(tick) + 4);
  }

  /** The name of the curve is short where there is little room. */
  drawTimes() {
    const {times} = this;
    const {pen, colour, height, width} = this.paper;
    const end = `${Math.round(times.at(-1))} s`, name = "NEES ratio, 95 % band";
    const room = width - 50 - pen.measureText(end).width;
    this.paper.line(colour.soft, 1);
    pen.textAlign = "right";
    pen.fillText(end, width - 8, height - 5);
    pen.textAlign = "left";
    pen.fillText(pen.measureText(name).width < room ? name : "NEES ratio", 34, height - 5);
  }

  drawCurve(cell, f) {
    const {nees, colour} = cell.data;
    const {pen} = this.paper;
    this.paper.line(colour, 1.3);
    pen.beginPath();
    let last = null;
    for (let k = 0; k <= f; ++k) {
      if (nees[k] === null) {
        last = null;
        continue;
      }
      const x = this.x(this.times[k]), y = this.y(nees[k]);
      if (last === null) pen.moveTo(x, y);
      else pen.lineTo(x, y);
      last = {x, y};
    }
    pen.stroke();
    if (last === null) return;
    pen.beginPath();
    pen.arc(last.x, last.y, 2.6, 0, 2 * Math.PI);
    pen.fill();
  }
}
