// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/render/page/html.hpp"

#include <string>

namespace montecarta::analysis {

/// A rectangle of the drawing [px].
struct Box {
  double left, top, width, height;
};

/// An SVG document that is built piece by piece.
class Drawing {
 public:
  /// Begins a group that is clipped to the box, until end().
  void begin(const Box& box) {
    svg_ += "<svg x=\"" + pixels(box.left) + "\" y=\"" + pixels(box.top) + "\" width=\"" +
            pixels(box.width) + "\" height=\"" + pixels(box.height) + "\">\n";
  }
  void end() { svg_ += "</svg>\n"; }
  /// Adds a path; `style` is a list of attributes.
  void path(const std::string& d, const std::string& style) {
    if (!d.empty()) svg_ += "<path d=\"" + d + "\" " + style + "/>\n";
  }
  void rectangle(const Box& box, const std::string& style) {
    svg_ += "<rect x=\"" + pixels(box.left) + "\" y=\"" + pixels(box.top) + "\" width=\"" +
            pixels(box.width) + "\" height=\"" + pixels(box.height) + "\" " + style + "/>\n";
  }
  void circle(double x, double y, double radius, const std::string& style) {
    svg_ += "<circle cx=\"" + pixels(x) + "\" cy=\"" + pixels(y) + "\" r=\"" + pixels(radius) +
            "\" " + style + "/>\n";
  }
  void text(double x, double y, const std::string& words, const std::string& style) {
    svg_ += "<text x=\"" + pixels(x) + "\" y=\"" + pixels(y) + "\" " + style + ">" +
            html_escape(words) + "</text>\n";
  }
  void ellipse(double x, double y, double a, double b, double angle, const std::string& style) {
    svg_ += "<ellipse rx=\"" + pixels(a) + "\" ry=\"" + pixels(b) + "\" transform=\"translate(" +
            pixels(x) + " " + pixels(y) + ") rotate(" + pixels(angle) + ")\" " + style + "/>\n";
  }
  const std::string& svg() const { return svg_; }

 private:
  std::string svg_;
};

}  // namespace montecarta::analysis
