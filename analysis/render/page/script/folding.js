// SPDX-License-Identifier: BSD-3-Clause
// Sections that are folded until the reader opens them, follows a link into them, or prints.

/** Calls `make` when nothing around the element is folded any more, which may be now. */
function onceUnfolded(element, make) {
  const folded = element.closest("details:not([open])");
  if (!folded) make();
  else folded.addEventListener("toggle", () => onceUnfolded(element, make), {once: true});
}

/** Opens the section that the address names, or those around what it names, and goes there. */
function showTarget() {
  const target = document.querySelector(":target");
  if (!target) return;
  let folded = target.querySelector(":scope > details.folded") ?? target.closest("details");
  for (; folded; folded = folded.parentElement.closest("details")) folded.open = true;
  target.scrollIntoView();
}

/** Paper holds all sections; explanations on cards are those of the tables once more. */
class OpenedForPrint {
  constructor() {
    this.opened = [];
    addEventListener("beforeprint", () => this.open());
    addEventListener("afterprint", () => this.close());
  }

  open() {
    this.opened = [...document.querySelectorAll(
      "details.folded:not([open]), details.why:not([open]):not(.card *)")];
    for (const details of this.opened) details.open = true;
  }

  close() {
    for (const details of this.opened) details.open = false;
    this.opened = [];
  }
}

/** A table or figure that is wider than its place says that it scrolls, and keys scroll it. */
function markScrolling(box) {
  const scrolls = box.scrollWidth > box.clientWidth;
  box.classList.toggle("scrolls", scrolls);
  if (scrolls) fill(box, {tabindex: 0, role: "region", "aria-label": "Scrolls sideways"});
  else for (const name of ["tabindex", "role", "aria-label"]) box.removeAttribute(name);
}
