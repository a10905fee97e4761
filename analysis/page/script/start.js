// SPDX-License-Identifier: BSD-3-Clause
// Brings every figure that has data to life; without scripts its drawing stays.

/** The data in a script element; JSON has no infinite numbers, which are these texts there. */
function parsed(element) {
  return JSON.parse(element.textContent, (key, value) =>
    value === "+inf" ? Infinity : value === "-inf" ? -Infinity : value);
}

for (const element of document.querySelectorAll("figure > script.chart-data")) {
  new ChartFigure(element.parentElement, parsed(element));
}
for (const element of document.querySelectorAll(".player > script.replay-data")) {
  new Player(element.parentElement, parsed(element));
}
