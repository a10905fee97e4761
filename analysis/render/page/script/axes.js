// SPDX-License-Identifier: BSD-3-Clause
// An axis is {logarithmic, from, to}. Its `share` runs from 0 at `from` to 1 at `to`.

function shareOf(axis, value) {
  if (!axis.logarithmic) return (value - axis.from) / (axis.to - axis.from);
  return Math.log(value / axis.from) / Math.log(axis.to / axis.from);
}

function valueAt(axis, share) {
  if (!axis.logarithmic) return axis.from + share * (axis.to - axis.from);
  return axis.from * (axis.to / axis.from) ** share;
}

/** The part of an axis between two shares, which may lie outside it. */
function stretch(axis, first, last) {
  return {...axis, from: valueAt(axis, first), to: valueAt(axis, last)};
}

/** Nearer (factor < 1) or farther, with the value at `share` staying where it is. */
function zoomed(axis, share, factor) {
  return stretch(axis, share * (1 - factor), share + (1 - share) * factor);
}

/** Moved and, if need be, shortened so that nothing outside `whole` is shown. */
function within(axis, whole) {
  const length = shareOf(whole, axis.to) - shareOf(whole, axis.from);
  if (length >= 1) return {...whole};
  const first = clamp(shareOf(whole, axis.from), 0, 1 - length);
  return stretch(whole, first, first + length);
}

/** Whether so short a stretch still shows more than rounding errors. */
function isWideEnough(axis, whole) {
  return shareOf(whole, axis.to) - shareOf(whole, axis.from) > 1e-4;
}

function ticksOf(axis, most) {
  return axis.logarithmic ? logarithmicTicks(axis.from, axis.to, most)
                          : linearTicks(axis.from, axis.to, most);
}
