// SPDX-License-Identifier: BSD-3-Clause
// Brings every figure that has data to life; without scripts its drawing stays.

for (const element of document.querySelectorAll("figure > script.chart-data")) {
  new ChartFigure(element.parentElement, JSON.parse(element.textContent));
}
for (const element of document.querySelectorAll(".player > script.replay-data")) {
  new Player(element.parentElement, JSON.parse(element.textContent));
}
