// SPDX-License-Identifier: BSD-3-Clause
// Draws the last moment of a replay as page/script/panel.js shows it for each cell.
#include "analysis/render/page/replay/replay_still.hpp"

#include "analysis/render/page/drawing.hpp"
#include "analysis/render/page/html.hpp"
#include "analysis/render/page/replay/replay.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kMostDrawnCells = 4;
constexpr double kPanelWidth = 380.0, kSpace = 24.0, kHead = 30.0, kLower = 130.0;  // sizes in px
constexpr double kLeastNees = 0.1, kMostNees = 1e6;

std::string stroke(const std::string& colour, double width, const char* opacity = "1") {
  return "fill=\"none\" stroke-linejoin=\"round\" stroke=\"" + colour + "\" stroke-width=\"" +
         pixels(width) + "\" stroke-opacity=\"" + opacity + "\"";
}

constexpr const char* kText = "currentColor";
constexpr const char* kTruth = "#999999";
constexpr double kScaleCharacter = 7.0;  // [px] largest width of a character of kSoftText
constexpr const char* kSoftText = "font-size=\"12\" fill=\"#777777\"";

/// Transformation from metres to pixels of a box that is `width` by `height` [px], with y upwards.
struct View {
  double x_centre, y_centre, scale, width, height;
  double x(double metres) const { return width / 2.0 + (metres - x_centre) * scale; }
  double y(double metres) const { return height / 2.0 - (metres - y_centre) * scale; }
  /// Returns whether a point is in the picture; false for NaN.
  bool shows(double metres_x, double metres_y) const {
    return std::abs(x(metres_x) - width / 2.0) < width &&
           std::abs(y(metres_y) - height / 2.0) < height;
  }
};

/// Returns bounds of the drive. Those of the estimates are used only if nothing else is known,
/// because a filter may be lost.
Bounds bounds_of(const Replay& replay) {
  Bounds bounds;
  for (std::size_t f = 0; f < replay.x.size(); ++f) bounds.include(replay.x[f], replay.y[f]);
  for (const auto* points : {&replay.landmarks, &replay.fixes}) {
    for (const auto& [x, y] : *points) bounds.include(x, y);
  }
  if (!bounds.empty()) return bounds.widened();
  for (const ReplayCell& cell : replay.cells) {
    for (std::size_t f = 0; f < cell.x.size(); ++f) bounds.include(cell.x[f], cell.y[f]);
  }
  bounds.include(0.0, 0.0);
  return bounds.widened();
}

View whole_view(const Bounds& bounds) {
  const double width = bounds.right - bounds.left, height = bounds.high - bounds.low;
  const double scale = kPanelWidth / width;
  return {(bounds.left + bounds.right) / 2.0, (bounds.low + bounds.high) / 2.0, scale, kPanelWidth,
          std::round(std::clamp(height * scale, 160.0, 460.0))};
}

std::string point(double x, double y, const View& view) {
  return pixels(view.x(x)) + " " + pixels(view.y(y));
}

/// A path with gaps at NaN, and between points that are both out of the picture.
std::string path_of(const std::vector<double>& x, const std::vector<double>& y, const View& view) {
  std::string d;
  const auto is_known = [&](std::size_t f) { return std::isfinite(x[f]) && std::isfinite(y[f]); };
  bool is_drawing = false;
  for (std::size_t f = 1; f < x.size(); ++f) {
    const bool is_seen = is_known(f - 1) && is_known(f) &&
                         (view.shows(x[f - 1], y[f - 1]) || view.shows(x[f], y[f]));
    if (is_seen && !is_drawing) d += "M" + point(x[f - 1], y[f - 1], view);
    if (is_seen) d += "L" + point(x[f], y[f], view);
    is_drawing = is_seen;
  }
  return d;
}

/// The paths of the ancestors of the particles that exist at the end, each path once.
std::string lineages_of(const ReplayCell& cell, const View& view) {
  const auto& frames = cell.particles.frames;
  std::string d;
  if (frames.empty()) return d;
  std::vector<std::uint32_t> alive(frames.back().shown.size());
  for (std::uint32_t i = 0; i < alive.size(); ++i) alive[i] = i;
  for (std::size_t f = frames.size() - 1; f > 0 && !frames[f].parent.empty(); --f) {
    const auto &here = frames[f], &before = frames[f - 1];
    for (std::uint32_t& i : alive) {
      const std::uint32_t parent = here.parent[i];
      if (view.shows(before.x[parent], before.y[parent]) && view.shows(here.x[i], here.y[i])) {
        d += "M" + point(before.x[parent], before.y[parent], view) + "L" +
             point(here.x[i], here.y[i], view);
      }
      i = parent;
    }
    std::ranges::sort(alive);
    alive.erase(std::unique(alive.begin(), alive.end()), alive.end());
  }
  return d;
}

void draw_ellipse(const Ellipse& e, const std::string& colour, const View& view, Drawing& drawing) {
  if (!std::isfinite(e.major) || !std::isfinite(e.minor) || !view.shows(e.x, e.y)) return;
  drawing.ellipse(view.x(e.x), view.y(e.y), std::max(e.major * view.scale / 2.0, 1.5),
                  std::max(e.minor * view.scale / 2.0, 1.5), -e.angle,
                  "fill=\"" + colour + "\" fill-opacity=\"0.14\" stroke=\"" + colour +
                      "\" stroke-width=\"1.1\"");
}

/// Draws the map after its last change.
void draw_map(const ReplayCell& cell, const std::string& colour, const View& view,
              Drawing& drawing) {
  std::vector<ReplayMap::DrawnLandmark> latest;
  for (const ReplayMap& map : cell.maps) {
    for (const ReplayMap::DrawnLandmark& landmark : map.changed) {
      const auto found = std::ranges::find(latest, landmark.row, &ReplayMap::DrawnLandmark::row);
      if (found == latest.end())
        latest.push_back(landmark);
      else
        *found = landmark;
    }
  }
  for (const ReplayMap::DrawnLandmark& landmark : latest) {
    draw_ellipse(landmark.ellipse, colour, view, drawing);
  }
}

void draw_surroundings(const Replay& replay, const View& view, Drawing& drawing) {
  std::string crosses, dots;
  for (const auto& [x, y] : replay.landmarks) {
    if (!view.shows(x, y)) continue;
    const std::string left = pixels(view.x(x) - 3.0), top = pixels(view.y(y) - 3.0);
    crosses += "M" + left + " " + pixels(view.y(y)) + "h6M" + pixels(view.x(x)) + " " + top + "v6";
  }
  for (const auto& [x, y] : replay.fixes) {
    if (!view.shows(x, y)) continue;
    dots += "M" + pixels(view.x(x) - 1.0) + " " + pixels(view.y(y)) + "h2";
  }
  drawing.path(dots, stroke(kTruth, 2.0));
  drawing.path(crosses, stroke(kText, 1.0, "0.55"));
}

void draw_particles(const ReplayCell& cell, const std::string& colour, double radius,
                    const View& view, Drawing& drawing) {
  if (cell.particles.frames.empty()) return;
  const ReplayParticles::Snapshot& frame = cell.particles.frames.back();
  for (std::size_t i = 0; i < frame.x.size(); ++i) {
    const double weight = frame.weight.empty() ? 1.0 : frame.weight[i];
    if (!view.shows(frame.x[i], frame.y[i]) || !std::isfinite(weight)) continue;
    drawing.circle(
        view.x(frame.x[i]), view.y(frame.y[i]), radius,
        "fill=\"" + colour + "\" fill-opacity=\"" + pixels(0.1 + 0.7 * std::sqrt(weight)) + "\"");
  }
}

/// Draws an arrow head at the end of a path.
void draw_vehicle(const std::vector<double>& x, const std::vector<double>& y,
                  const std::vector<double>& h, const View& view, const std::string& style,
                  Drawing& drawing) {
  if (x.empty() || !std::isfinite(x.back())) return;
  drawing.path("M9 0L-6 5L-3 0L-6 -5Z", "transform=\"translate(" + pixels(view.x(x.back())) + " " +
                                            pixels(view.y(y.back())) + ") rotate(" +
                                            pixels(-h.back() * 180.0 / kPi) + ")\" " + style);
}

/// Draws a bar of a round number of metres, on the colour of the paper.
void draw_scale(const View& view, Drawing& drawing) {
  const double most = view.width / view.scale / 4.5;
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  const double metres = (most >= 5.0 * power ? 5.0 : most >= 2.0 * power ? 2.0 : 1.0) * power;
  const double y = view.height - 8.0;
  const std::string text = exact_text(metres) + " m";
  const double text_width = kScaleCharacter * static_cast<double>(text.size());
  drawing.rectangle({4.0, y - 17.0, std::max(metres * view.scale, 4.0 + text_width) + 8.0, 21.0},
                    "fill=\"#ffffff\" fill-opacity=\"0.85\"");
  drawing.path("M8 " + pixels(y - 3.0) + "v3h" + pixels(metres * view.scale) + "v-3",
               stroke("#777777", 1.0));
  drawing.text(12.0, y - 5.0, text, kSoftText);
}

/// Draws truth, estimate, particles and map; `size` is that of dots and lines relative to the usual
/// one.
void draw_scene(const Replay& replay, const ReplayCell& cell, const View& view, double size,
                Drawing& drawing) {
  const std::string colour = line_colour(cell.style);
  draw_surroundings(replay, view, drawing);
  draw_map(cell, colour, view, drawing);
  drawing.path(path_of(replay.x, replay.y, view), stroke(kTruth, 2.4 * size));
  drawing.path(lineages_of(cell, view), stroke(colour, 0.6, "0.4"));
  drawing.path(path_of(cell.x, cell.y, view), stroke(colour, 1.3 * size));
  if (!cell.pose.empty()) draw_ellipse(cell.pose.back(), colour, view, drawing);
  draw_particles(cell, colour, 1.6 * size, view, drawing);
  draw_vehicle(cell.x, cell.y, cell.h, view, "fill=\"" + colour + "\"", drawing);
  draw_vehicle(replay.x, replay.y, replay.h, view, stroke(kText, 1.3), drawing);
  draw_scale(view, drawing);
}

/// The axes of the NEES, the same for all cells.
struct GrowthAxes {
  Box box;
  double from, to, greatest;
  double x(double time) const {
    return box.left + (time - from) / std::max(to - from, 1e-9) * box.width;
  }
  double y(double nees) const {
    const double share = std::log(std::max(nees, kLeastNees) / kLeastNees);
    return box.top + (1.0 - std::min(share / std::log(greatest / kLeastNees), 1.0)) * box.height;
  }
};

GrowthAxes growth_axes(const Replay& replay, const Box& box) {
  double greatest = 20.0;
  for (const ReplayCell& cell : replay.cells) {
    greatest = std::max(greatest, 2.0 * cell.nees_band.upper);
    for (const double value : cell.nees) {
      if (std::isfinite(value)) greatest = std::max(greatest, 1.3 * value);
    }
  }
  return {box, replay.times.front(), replay.times.back(), std::min(greatest, kMostNees)};
}

/// Text of a power of ten, from the third on with a raised exponent.
std::string power_text(int power) {
  constexpr std::array kSuperscripts = {"\u2070", "\u00b9", "\u00b2", "\u00b3",
                                        "\u2074", "\u2075", "\u2076"};
  return power < 3 ? exact_text(std::pow(10.0, power))
                   : std::string("10") + kSuperscripts.at(static_cast<std::size_t>(power));
}

void draw_growth(const Replay& replay, const ReplayCell& cell, const GrowthAxes& axes,
                 Drawing& drawing) {
  const auto [left, top, width, height] = axes.box;
  const double high = axes.y(cell.nees_band.upper);
  drawing.rectangle({left, high, width, axes.y(cell.nees_band.lower) - high},
                    "fill=\"#808080\" fill-opacity=\"0.22\"");
  const std::string end = std::string(kSoftText) + " text-anchor=\"end\"";
  const double decades = std::log10(axes.greatest / kLeastNees);
  for (int power = -1; power <= static_cast<int>(decades) - 1; power += decades < 4.0 ? 1 : 2) {
    const double tick = std::pow(10.0, power);
    drawing.path("M" + pixels(left) + " " + pixels(axes.y(tick)) + "h" + pixels(width),
                 stroke("#d5d5d5", 0.6));
    drawing.text(left - 5.0, axes.y(tick) + 4.0, power_text(power), end);
  }
  drawing.text(left, top + height + 17.0, "NEES ratio, " + level_text(kReplayShare) + " band",
               kSoftText);
  drawing.text(left + width, top + height + 17.0, exact_text(std::round(axes.to)) + " s", end);
  std::string d;
  bool is_drawing = false;
  for (std::size_t f = 0; f < cell.nees.size(); ++f) {
    const bool is_known = std::isfinite(cell.nees[f]);
    if (is_known) {
      d += (is_drawing ? "L" : "M") + pixels(axes.x(replay.times[f])) + " " +
           pixels(axes.y(cell.nees[f]));
    }
    is_drawing = is_known;
  }
  drawing.path(d, stroke(line_colour(cell.style), 1.3));
}

/// Draws the name of the cell with "failed" or its last NEES ratio.
void draw_head(const ReplayCell& cell, const Box& box, Drawing& drawing) {
  drawing.circle(box.left + 6.0, box.top + 13.0, 6.0, "fill=\"" + line_colour(cell.style) + "\"");
  drawing.text(box.left + 20.0, box.top + 18.0, cell.label,
               "font-size=\"16\" font-weight=\"600\" fill=\"currentColor\"");
  const std::string end = !cell.failure.empty() ? "failed"
                          : cell.nees.empty()   ? ""
                                              : "this run: NEES ratio " + compact(cell.nees.back());
  drawing.text(box.left + box.width, box.top + 18.0, end,
               "font-size=\"14\" fill=\"#777777\" text-anchor=\"end\"");
}

void draw_panel(const Replay& replay, const ReplayCell& cell, const View& view, const Box& box,
                Drawing& drawing) {
  const std::string frame = stroke("#d5d5d5", 1.0);
  draw_head(cell, box, drawing);
  const Box scene{box.left, box.top + kHead, view.width, view.height};
  drawing.begin(scene);
  draw_scene(replay, cell, view, 1.0, drawing);
  drawing.end();
  drawing.rectangle(scene, frame);

  const bool is_true = !replay.x.empty();
  const View near{is_true ? replay.x.back() : cell.x.back(),
                  is_true ? replay.y.back() : cell.y.back(), kLower / (2.0 * replay.close_up),
                  kLower, kLower};
  const double top = scene.top + scene.height + 10.0;
  const Box close{box.left, top, kLower, kLower};
  drawing.begin(close);
  draw_scene(replay, cell, near, 1.4, drawing);
  drawing.end();
  drawing.rectangle(close, frame);
  if (cell.nees.empty()) return;
  const double left = box.left + kLower + 44.0;
  const Box growth{left, top + 6.0, box.left + box.width - left, kLower - 28.0};
  draw_growth(replay, cell, growth_axes(replay, growth), drawing);
}

}  // namespace

std::string replay_still(const Replay& replay) {
  if (replay.cells.empty()) return "";
  const std::size_t panels = std::min(replay.cells.size(), kMostDrawnCells);
  const std::size_t columns = panels <= 3 ? panels : 2, rows = (panels + columns - 1) / columns;
  const View view = whole_view(bounds_of(replay));
  const double height = kHead + view.height + 10.0 + kLower;
  Drawing drawing;
  for (std::size_t i = 0; i < panels; ++i) {
    const std::size_t in_row = i % columns, before = i / columns;
    const auto column = static_cast<double>(in_row), row = static_cast<double>(before);
    draw_panel(replay, replay.cells[i], view,
               {kSpace + column * (kPanelWidth + kSpace), kSpace / 2.0 + row * (height + kSpace),
                kPanelWidth, height},
               drawing);
  }
  const std::string size = pixels(kSpace + static_cast<double>(columns) * (kPanelWidth + kSpace)) +
                           " " + pixels(static_cast<double>(rows) * (height + kSpace));
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + size +
         "\" font-family=\"system-ui, sans-serif\" color=\"black\">\n"
         "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n" +
         drawing.svg() + "</svg>\n";
}

}  // namespace montecarta::analysis
