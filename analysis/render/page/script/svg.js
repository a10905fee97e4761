// SPDX-License-Identifier: BSD-3-Clause
// Elements of a page, made and filled in one call.

function fill(element, attributes, parent) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "text") element.textContent = value;
    else element.setAttribute(name, value);
  }
  if (parent) parent.append(element);
  return element;
}

function svgElement(name, attributes = {}, parent = null) {
  return fill(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, parent);
}

function htmlElement(name, attributes = {}, parent = null) {
  return fill(document.createElement(name), attributes, parent);
}

/** How a curve is dashed, by its number: the same order as in the printed figures. */
const DASHES = ["", "7 4", "2 3", "9 3 2 3", "9 3 2 3 2 3"];

function lineStyle(curve) {
  const dashes = DASHES[(curve.dash - 1) % DASHES.length];
  // Black on paper is light on a dark page.
  const stroke = curve.colour === "black" ? "currentColor" : curve.colour;
  return dashes ? {stroke, "stroke-dasharray": dashes} : {stroke};
}
