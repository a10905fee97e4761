// SPDX-License-Identifier: BSD-3-Clause
// Numbers as a reader wants them, and where the ticks of an axis stand.

/** Significant digits without needless zeros; powers of ten only for the very large and small. */
function readable(value, digits = 4) {
  if (value === null || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e5 || size < 1e-3 ? value.toExponential(digits - 1)
                                          : value.toPrecision(digits);
  return String(Number(text)).replace("e+", "e").replace(/-/g, "−");
}

function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}

/** A distance of 1, 2 or 5 times a power of ten that cuts `span` into at most `most` parts. */
function niceDistance(span, most) {
  const power = 10 ** Math.floor(Math.log10(span / most));
  return [1, 2, 5, 10].map((step) => step * power).find((step) => span / step <= most * 1.001);
}

function linearTicks(from, to, most) {
  const distance = niceDistance(to - from, most);
  const first = Math.ceil(from / distance - 1e-9);
  const last = Math.floor(to / distance + 1e-9);
  // Counting steps keeps 0.3 from becoming 0.30000000000000004.
  return Array.from({length: last - first + 1}, (_, i) =>
    Number(((first + i) * distance).toPrecision(12)));
}

/** Powers of ten, as many as there is room for; between them 2 and 5 where only few are seen. */
function logarithmicTicks(from, to, most) {
  const low = Math.log10(from), high = Math.log10(to);
  if (high - low < 0.7) return linearTicks(from, to, most).filter((tick) => tick > 0);
  const factors = high - low < 2 ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil((high - low) / most));
  const ticks = [];
  for (let power = Math.floor(low); power <= high + 1e-9; ++power) {
    if (power % every !== 0) continue;
    ticks.push(...factors.map((factor) => factor * 10 ** power));
  }
  return ticks.filter((tick) => tick >= from * 0.999 && tick <= to * 1.001);
}
