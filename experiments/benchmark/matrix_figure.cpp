// SPDX-License-Identifier: BSD-3-Clause
// Draws the matrix of a benchmark: a row for each filter, and a column for each world.
#include "experiments/benchmark/matrix_figure.hpp"

#include "analysis/render/page/drawing.hpp"
#include "analysis/render/page/html.hpp"
#include "engine/formatted.hpp"
#include "engine/text/number_text.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::experiments {
namespace {

// Sizes in px.
constexpr double kPlaceWidth = 50.0, kPlaceHeight = 46.0, kLabels = 128.0, kHeadings = 62.0;
constexpr double kMargin = 12.0, kLegendLine = 22.0;
constexpr std::size_t kLegendColumns = 4;

constexpr const char* kHeading = "font-size=\"12\" fill=\"#222222\" text-anchor=\"middle\"";
constexpr const char* kRowLabel = "font-size=\"13\" fill=\"#222222\" text-anchor=\"end\"";
constexpr const char* kRatio =
    "font-size=\"14\" font-weight=\"600\" fill=\"#111111\" text-anchor=\"middle\"";
constexpr const char* kSmall = "font-size=\"10.5\" fill=\"#333333\" text-anchor=\"middle\"";
constexpr const char* kNote = "font-size=\"12\" fill=\"#444444\"";

std::string time_text(double seconds) {
  if (std::isnan(seconds)) return "";
  return seconds < 1e-3  ? readable(1e6 * seconds, 2) + " \u00b5s"
         : seconds < 1.0 ? readable(1e3 * seconds, 2) + " ms"
                         : readable(seconds, 2) + " s";
}

void draw_place(const Matrix::Place& place, double x, double y, Drawing& drawing) {
  const Box box{x + 1.0, y + 1.0, kPlaceWidth - 2.0, kPlaceHeight - 2.0};
  const double middle = x + kPlaceWidth / 2.0;
  if (place.entry == nullptr) {
    drawing.rectangle(box, place.suits ? "fill=\"none\" stroke=\"#cccccc\" stroke-dasharray=\"3 3\""
                                       : "fill=\"#f7f7f7\"");
    if (!place.suits) drawing.text(middle, y + 27.0, "\u2013", kSmall);
    return;
  }
  drawing.rectangle(box, formatted("fill=\"{}\"", class_of(place.entry->verdict).colour));
  drawing.text(middle, y + 16.0, ratio_text(place.entry->verdict.ratio), kRatio);
  if (std::isfinite(place.relative_error))
    drawing.text(middle, y + 29.0, "\u00d7" + readable(place.relative_error), kSmall);
  drawing.text(middle, y + 41.0, time_text(place.entry->cpu_seconds), kSmall);
}

/// The words of a world's name, on lines of their own.
void draw_heading(const std::string& world, double middle, double bottom, Drawing& drawing) {
  const std::vector<std::string> words = split(world, '_');
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto below = static_cast<double>(words.size() - 1 - i);
    drawing.text(middle, bottom - 14.0 * below, words[i], kHeading);
  }
}

/// Draws the classes that occur, and what the numbers mean. Returns its lower end.
double draw_legend(const Matrix& matrix, double top, Drawing& drawing) {
  std::size_t drawn = 0;
  for (const VerdictClass& one : verdict_classes()) {
    const bool occurs = std::ranges::any_of(matrix.rows, [&](const Matrix::Row& row) {
      return std::ranges::any_of(row.places, [&](const Matrix::Place& place) {
        return place.entry != nullptr &&
               std::string(class_of(place.entry->verdict).colour) == one.colour;
      });
    });
    if (!occurs) continue;
    const std::size_t column = drawn % kLegendColumns, line = drawn / kLegendColumns;
    const double x = kMargin + 205.0 * static_cast<double>(column);
    const double y = top + kLegendLine * static_cast<double>(line);
    drawing.rectangle({x, y, 14.0, 14.0}, formatted("fill=\"{}\"", one.colour));
    drawing.text(x + 20.0, y + 11.5, one.name, kNote);
    ++drawn;
  }
  const std::size_t lines = (drawn + kLegendColumns - 1) / kLegendColumns;
  const double y = top + kLegendLine * static_cast<double>(lines) + 12.0;
  const bool has_smoother = std::ranges::any_of(matrix.rows, [](const Matrix::Row& row) {
    return std::ranges::any_of(
        row.places, [](const Matrix::Place& place) { return std::isfinite(place.relative_error); });
  });
  drawing.text(kMargin, y,
               formatted("Bold: NEES ratio, 1 if squared errors are as large as claimed.{}",
                         has_smoother ? " \u00d7: position RMSE relative to full smoothing." : ""),
               kNote);
  drawing.text(kMargin, y + 17.0,
               "Below: processor time of a run. Dashed: not computed. \u2013: the world does not "
               "suit the filter.",
               kNote);
  return y + 17.0 + kMargin;
}

}  // namespace

std::string matrix_figure(const Matrix& matrix) {
  Drawing drawing;
  const double top = kMargin + kHeadings;
  for (std::size_t w = 0; w < matrix.worlds.size(); ++w) {
    const double x = kLabels + kPlaceWidth * static_cast<double>(w);
    draw_heading(matrix.worlds[w], x + kPlaceWidth / 2.0, top - 8.0, drawing);
    for (std::size_t r = 0; r < matrix.rows.size(); ++r)
      draw_place(matrix.rows[r].places[w], x, top + kPlaceHeight * static_cast<double>(r), drawing);
  }
  for (std::size_t r = 0; r < matrix.rows.size(); ++r) {
    drawing.text(kLabels - 8.0, top + kPlaceHeight * (static_cast<double>(r) + 0.5) + 4.0,
                 matrix.rows[r].label, kRowLabel);
  }
  const double below = top + kPlaceHeight * static_cast<double>(matrix.rows.size()) + 16.0;
  const double height = draw_legend(matrix, below, drawing);
  const double width =
      std::max(kLabels + kPlaceWidth * static_cast<double>(matrix.worlds.size()), 700.0) + kMargin;
  return formatted(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"system-ui, "
      "sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{}</svg>\n",
      pixels(width), pixels(height), drawing.svg());
}

std::string matrix_page(const Matrix& matrix) {
  std::string body = "<h1>Which filter is consistent where</h1>\n";
  body += formatted(
      "<figure>\n<div class=\"scroll\">{}</div>\n</figure>\n",
      inline_svg(matrix_figure(matrix), "matrix",
                 "A row for each filter and a column for each world, coloured by the verdict"));
  for (std::size_t w = 0; w < matrix.worlds.size(); ++w) {
    body += formatted("<h2>{}</h2>\n", html_escape(matrix.worlds[w]));
    body += html_table(world_table(matrix, w));
  }
  return html_page("Which filter is consistent where", body);
}

}  // namespace montecarta::experiments
