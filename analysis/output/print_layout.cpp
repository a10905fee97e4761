// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/print_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace montecarta::analysis {
namespace {

// [px]
constexpr double kAxisRoom = 76.0, kNarrowAxisRoom = 48.0;  // beside a panel: numbers and label
constexpr double kRightRoom = 14.0, kHeading = 26.0, kTicks = 54.0, kGap = 18.0;
constexpr std::size_t kMostColumns = 3;
constexpr double kSingleHeight = 250.0, kUsualHeight = 160.0;

double panel_height(const Chart& chart, double panel_width) {
  if (chart.aspect > 0.0) return chart.aspect * panel_width;
  if (chart.height > 0.0) return chart.height;
  return chart.panels.size() == 1 ? kSingleHeight : kUsualHeight;
}

}  // namespace

PrintLayout print_layout(const Chart& chart, double width, double legend_height) {
  PrintLayout layout;
  const bool is_zoomed = chart.x_first > chart.x_from;
  layout.views = is_zoomed ? 2 : 1;
  const std::size_t count = layout.views * chart.panels.size();
  const std::size_t columns =
      std::min(is_zoomed ? 2 : std::min(chart.columns, kMostColumns), count);
  const std::size_t rows = (count + columns - 1) / columns;
  const bool headings = columns > 1 || !chart.panels.front().cell.empty();
  const double room = headings ? kNarrowAxisRoom : kAxisRoom;
  // One map alone needs no more than half of the width.
  const double each =
      chart.is_map && columns == 1 ? 0.5 * width : width / static_cast<double>(columns);
  const double start = 0.5 * (width - each * static_cast<double>(columns));
  const double panel_width = each - room - kRightRoom;
  const double height = panel_height(chart, panel_width);
  const double pitch = height + kGap + (headings ? kHeading : 0.0);
  const double first_top = legend_height + (headings ? kHeading : 8.0);
  layout.height =
      std::ceil(first_top + static_cast<double>(rows) * pitch - (pitch - height) + kTicks);
  const std::array<double, 2> begins = {chart.x_from, chart.x_first};
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t row = k / columns, column = k % columns;
    const double left = start + static_cast<double>(column) * each + room;
    const double top = first_top + static_cast<double>(row) * pitch;
    layout.boxes.push_back({left, left + panel_width, top, top + height, k + columns >= count,
                            columns == 1, headings, begins[k % layout.views], chart.x_to});
  }
  return layout;
}

}  // namespace montecarta::analysis
