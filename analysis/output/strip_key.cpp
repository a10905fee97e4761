// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/gnuplot.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/output/strips.hpp"

#include <algorithm>

namespace montecarta::analysis {
namespace {

/// The drawing from its upper left corner, in pixels.
class Sheet {
 public:
  Sheet(double width, double height) : width_(width), height_(height) {}

  std::string rectangle(const PanelBox& box, const std::string& colour) const {
    return "set object rectangle from " + at(box.left, box.bottom) + " to " +
           at(box.right, box.top) + " behind noclip fillcolor rgb '" + colour +
           "' fillstyle solid 1 noborder\n";
  }
  std::string text(double x, double y, const std::string& words, const std::string& align) const {
    return "set label " + gnuplot_quoted(words) + " at " + at(x, y) + " " + align + "\n";
  }

 private:
  std::string at(double x, double y) const {
    return "screen " + readable(x / width_, 6) + ",screen " + readable(1.0 - y / height_, 6);
  }
  double width_, height_;
};

}  // namespace

std::string strip_key(const ChartStrips& strips, const PanelBox& box, double width, double height) {
  const Sheet sheet(width, height);
  constexpr double kTop = 6.0, kBottom = 18.0, kMiddle = 12.0, kText = 29.0;
  constexpr double kLevelWidth = 10.0, kApart = 8.0, kScaleRoom = 140.0, kSample = 24.0;
  const std::vector<std::string>& colours = strip_colours();
  const std::size_t levels = colours.size() - 1;
  const double inside = kCharacter * static_cast<double>(strips.inside.size());
  const double length = kLevelWidth * static_cast<double>(levels) + kScaleRoom + kSample + inside;
  const double left = std::min(box.left, width - length - 2.0 * kApart);
  const auto place_of = [&](std::size_t level) {
    return left + kLevelWidth * static_cast<double>(level);
  };
  std::string key;
  for (std::size_t level = 0; level < levels; ++level)
    key += sheet.rectangle({place_of(level), place_of(level + 1), kTop, kBottom}, colours[level]);
  for (const StripTick& tick : strip_ticks())
    key += sheet.text(place_of(tick.level), kText, tick.text, "center");
  const double grey = place_of(levels) + kScaleRoom, end = grey + kSample;
  return key + sheet.text(place_of(levels) + kApart, kMiddle, kStripScale, "left") +
         sheet.rectangle({grey, end, kTop, kBottom}, colours.back()) +
         sheet.text(end + kApart, kMiddle, strips.inside, "left");
}

}  // namespace montecarta::analysis
