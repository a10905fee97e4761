// SPDX-License-Identifier: BSD-3-Clause
// Brings every figure that has data to life, when it is seen; without scripts its drawing stays.

/** The data in a script element; JSON has no infinite numbers, which are these texts there. */
function parsed(element) {
  return JSON.parse(element.textContent, (key, value) =>
    value === "+inf" ? Infinity : value === "-inf" ? -Infinity : value);
}

for (const element of document.querySelectorAll("figure > script.chart-data")) {
  onceUnfolded(element, () => new ChartFigure(element.parentElement, parsed(element)));
}
for (const element of document.querySelectorAll(".player > script.replay-data")) {
  new Player(element.parentElement, parsed(element));
}
for (const box of document.querySelectorAll(".scroll")) {
  new ResizeObserver(() => markScrolling(box)).observe(box);
}
document.addEventListener("click", ({target}) => {
  if (target.closest("a")?.hash && target.closest("a").hash === location.hash) showTarget();
});
addEventListener("hashchange", showTarget);
new OpenedForPrint();
showTarget();
