// SPDX-License-Identifier: BSD-3-Clause
// Equations are drawn by the MathJax beside the pages. It is read before MathJax itself.
window.MathJax = {
  jax: ["input/TeX", "output/SVG"],
  extensions: ["tex2jax.js"],
  TeX: { extensions: ["AMSmath.js", "AMSsymbols.js"] },
  tex2jax: {
    inlineMath: [["\\(", "\\)"]],
    displayMath: [["\\[", "\\]"]],
    ignoreClass: ".*",
    processClass: "arithmatex",
  },
  SVG: { font: "TeX" },
  showMathMenu: false,
  messageStyle: "none",
};
