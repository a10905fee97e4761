// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/figures/gnuplot.hpp"

#include "analysis/study/strips.hpp"
#include "engine/errors.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"
#include "engine/text/shell_command.hpp"
#include "engine/text/visible_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace montecarta::analysis {
namespace {

// All sizes are in pixels.
constexpr double kCharacter = 7.8;  // width of most characters, in either font
// Room beside a panel for the numbers and the label of its axis.
constexpr double kAxisRoom = 76.0, kNarrowAxisRoom = 56.0;
constexpr double kRightRoom = 14.0, kHeading = 26.0, kTicks = 54.0, kGap = 18.0;
constexpr std::size_t kMostColumns = 3;
constexpr double kSingleHeight = 250.0, kUsualHeight = 160.0, kStripPitch = 22.0;
constexpr std::size_t kStripKeyHeight = 42;

bool has_strips(const Chart& chart) { return !chart.panels.front().strips.rows.empty(); }

/// Returns whether the vertical axis has names in place of numbers.
bool has_names(const ChartPanel& panel) { return !panel.names.empty(); }

/// Number of rows with a name: strips, or places with names; 0 if the vertical axis has numbers.
std::size_t named_rows(const ChartPanel& panel) {
  return panel.names.size() + panel.strips.rows.size();
}

/// Room left and right of a panel. Rows have as much room as their names and notes need.
std::array<double, 2> side_rooms(const Chart& chart, bool headings) {
  if (named_rows(chart.panels.front()) == 0)
    return {headings ? kNarrowAxisRoom : kAxisRoom, kRightRoom};
  std::size_t name = 0, note = 0;
  for (const ChartPanel& panel : chart.panels) {
    note = std::max(note, panel.strips.notes.size());
    for (const ChartStrips::Row& row : panel.strips.rows) {
      name = std::max(name, row.name.size());
      note = std::max(note, row.note.size());
    }
    for (const std::string& row : panel.names) name = std::max(name, row.size());
  }
  return {kRightRoom + kCharacter * static_cast<double>(name),
          kRightRoom + kCharacter * static_cast<double>(note)};
}

double panel_height(const Chart& chart, double panel_width) {
  const std::size_t rows = named_rows(chart.panels.front());
  if (rows > 0) return kStripPitch * static_cast<double>(rows);
  if (chart.aspect > 0.0) return chart.aspect * panel_width;
  if (chart.height > 0.0) return chart.height;
  return chart.panels.size() == 1 ? kSingleHeight : kUsualHeight;
}

/// Returns whether labels stand above their panels. They also do so if one is too long to stand
/// beside its axis.
bool has_headings(const Chart& chart, std::size_t columns) {
  if (columns > 1 || !chart.panels.front().cell.empty() || has_strips(chart)) return true;
  if (has_names(chart.panels.front())) return false;
  return chart.aspect == 0.0 && std::ranges::any_of(chart.panels, [&](const ChartPanel& panel) {
           return kCharacter * static_cast<double>(panel.label.size()) > panel_height(chart, 0.0);
         });
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
  const bool headings = has_headings(chart, columns);
  const auto [room, right_room] = side_rooms(chart, headings);
  // One map alone needs no more than half of the width.
  const double each =
      chart.is_map && columns == 1 ? 0.5 * width : width / static_cast<double>(columns);
  const double start = 0.5 * (width - each * static_cast<double>(columns));
  const double panel_width = each - room - right_room;
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

namespace {

constexpr const char* kNextSession = " -e 'reset session'";

}  // namespace

void run_gnuplot(const std::filesystem::path& directory, const std::vector<std::string>& scripts,
                 const std::string& program) {
  std::string command =
      "cd " + shell_quoted(directory.string()) + " && exec " + shell_quoted(program);
  for (const std::string& name : scripts) command += " " + shell_quoted(name) + kNextSession;
  const CommandOutcome outcome = run_command(command + " 2>&1", program);
  if (outcome.exit_code == CommandOutcome::kNotFound) {
    throw StudyError(program +
                     ": not found (it draws the figures): install it, on Debian with 'apt-get "
                     "install gnuplot-nox'");
  }
  if (outcome.has_succeeded()) return;
  throw RunError(
      "{}: gnuplot failed at {} ({}): draw them again by gnuplot, and look at what it says",
      directory, joined(scripts), outcome.last_line());
}

std::string gnuplot_quoted(const std::string& text) {
  return "'" + replaced(visible(text), "'", "''") + "'";
}

namespace {

using Shape = ChartMarks::Shape;
using Columns = std::vector<const std::vector<double>*>;

constexpr double kBeyondAnyAxis = 1e100;  // gnuplot has no infinity

/// A data block. A row that begins with NaN interrupts a line.
std::string block(const std::string& name, const Columns& columns) {
  std::string text = name + " << EOD\n";
  for (std::size_t c = 0; c < columns.size(); ++c) text += c == 0 ? "x" : ",y";
  text += "\n";
  for (std::size_t r = 0; r < columns.front()->size(); ++r) {
    const bool is_gap = std::isnan((*columns.front())[r]);
    for (std::size_t c = 0; c < columns.size() && !is_gap; ++c) {
      text += (c == 0 ? "" : ",") +
              exact_text(std::clamp((*columns[c])[r], -kBeyondAnyAxis, kBeyondAnyAxis));
    }
    text += "\n";
  }
  return text + "EOD\n";
}

std::string colour_of(std::size_t style) { return " linecolor rgb '" + line_colour(style) + "'"; }

std::string line_style(std::size_t style) {
  return "linewidth 1.4" + colour_of(style) + " dashtype " +
         (style == kReferenceStyle ? "(6,4)" : std::to_string(line_dashes(style)));
}

std::string band_style() {
  return "filledcurves fillcolor rgb '#707070' fillstyle transparent solid 0.45 border linecolor "
         "rgb '#666666' linewidth 0.6";
}

std::string curve_style(std::size_t style) { return "lines " + line_style(style); }

std::string mark_style(const ChartMarks& marks) {
  const auto points = [&](const char* type, double size) {
    return std::string("points pointtype ") + type + " pointsize " + exact_text(size) +
           colour_of(marks.style);
  };
  switch (marks.shape) {
    case Shape::line:
      if (marks.style == kReferenceStyle) return curve_style(marks.style);
      return "lines linewidth " + exact_text(marks.thickness > 0.0 ? marks.thickness : 1.4) +
             colour_of(marks.style) + " dashtype " + std::to_string(line_dashes(marks.style));
    case Shape::points:
      return points("7", marks.thickness > 0.0 ? 0.1 * marks.thickness : 0.5);
    case Shape::crosses:
      return points("1", 0.6);
    case Shape::ellipses:
      return points("6", 1.2);
  }
  return "";
}

/// Writes the data and the plot commands of a panel's bands, curves and marks, in the order in
/// which they cover each other. Each has a data block of its own.
class PanelWriter {
 public:
  PanelWriter(const Chart& chart, std::size_t panel)
      : chart_(chart), panel_(chart.panels[panel]), prefix_("$p" + std::to_string(panel) + "_") {
    for (const Band& band : panel_.bands) add(band);
    for (const Curve& curve : panel_.curves) add(curve);
    for (const ChartMarks& marks : panel_.marks) add(marks);
    if (!panel_.strips.rows.empty()) add(strip_boxes(panel_, chart.x_to));
  }

  const std::string& numbers() const { return numbers_; }  ///< text of the data blocks
  /// Text that follows gnuplot's command "plot".
  std::string commands() const { return commands_.empty() ? "NaN notitle" : commands_; }

 private:
  void add(const Band& band) {
    const std::vector<double> x = {chart_.x_from, chart_.x_to}, lower = {band.lower, band.lower},
                              upper = {band.upper, band.upper};
    plot({&x, &lower, &upper}, "1:2:3", band_style());
  }

  void add(const Curve& curve) {
    if (!curve.envelope.empty()) add_envelope(curve);
    plot({&panel_.x, &curve.values}, "1:2", curve_style(curve.style));
  }

  void add(const ChartMarks& marks) {
    if (marks.x.empty()) return;  // an empty data block is an error to gnuplot
    if (marks.shape == Shape::ellipses) return add_ellipses(marks);
    plot({&marks.x, &marks.y}, "1:2", mark_style(marks));
  }

  void add_envelope(const Curve& curve) {
    std::vector<double> below = curve.envelope;
    for (double& end : below) end = -end;
    plot({&panel_.x, &below, &curve.envelope}, "1:2:3",
         "filledcurves" + colour_of(curve.style) + " fillstyle transparent solid 0.25 noborder");
  }

  void plot(const Columns& columns, const std::string& which, const std::string& how) {
    const std::string name = prefix_ + std::to_string(count_++);
    numbers_ += block(name, columns);
    append_part(commands_, name + " using " + which + " with " + how + " notitle", ", \\\n  ");
  }

  /// Adds ellipses, enlarged where they are too small to be seen.
  void add_ellipses(const ChartMarks& marks) {
    const double least = 0.012 * (chart_.x_to - chart_.x_from);
    std::vector<double> width = marks.width, height = marks.height;
    for (double& one : width) one = one < least ? least : one;
    for (double& one : height) one = one < least ? least : one;
    plot({&marks.x, &marks.y, &width, &height, &marks.angle}, "1:2:3:4:5",
         "ellipses fillstyle empty border " + line_style(marks.style));
  }

  void add(const StripBoxes& boxes) {
    if (boxes.x.empty()) return;
    plot({&boxes.x, &boxes.y, &boxes.width, &boxes.height, &boxes.colour},
         "1:2:($1-$3/2):($1+$3/2):($2-$4/2):($2+$4/2):5",
         "boxxyerror linecolor rgb variable fillstyle solid 1 noborder");
  }

  const Chart& chart_;
  const ChartPanel& panel_;
  std::string prefix_, numbers_, commands_;
  std::size_t count_ = 0;
};

/// Settings of a panel. They follow those of the legend, for which everything is off.
constexpr const char* kPanelStyle = R"(set key off
set border 3 linewidth 0.8 linecolor rgb 'black'
set tics nomirror out scale 0.6
set grid linecolor rgb '#bbbbbb' linewidth 0.4 dashtype (2,4)
)";

/// An axis limit; gnuplot has no infinity.
double on_axis(double value) {
  constexpr double kLargest = 1e300;
  return std::isnan(value) ? 0.0 : std::clamp(value, -kLargest, kLargest);
}

std::string command_number(double value) { return exact_text(on_axis(value)); }

std::string range(const char* axis, double from, double to) {
  return std::string("set ") + axis + "range [" + command_number(from) + ":" + command_number(to) +
         "]\n";
}

/// Ticks at 0, 1, ... that have these names, or none unless they are `shown`.
std::string named_ticks(const std::vector<std::string>& names, bool shown = true) {
  std::string ticks;
  for (std::size_t k = 0; k < names.size(); ++k) {
    ticks += (k == 0 ? "" : ", ") + gnuplot_quoted(shown ? names[k] : "") + " " + std::to_string(k);
  }
  return "(" + ticks + ")";
}

/// Commands for the horizontal axis of a panel. If all columns have one label, common_label() puts
/// it below the drawing.
std::string horizontal_axis(const Chart& chart, const PanelBox& box) {
  const std::string label = box.is_alone_in_row ? "set xlabel " + gnuplot_quoted(chart.x_label) +
                                                      " noenhanced offset 0,0.4\n"
                                                : "unset xlabel\n";
  return std::string(chart.x_logarithmic ? "set" : "unset") + " logscale x\nset xtics nomirror " +
         (chart.x_names.empty() ? "autofreq" : named_ticks(chart.x_names, box.is_lowest)) + "\n" +
         range("x", box.x_from, box.x_to) +
         (box.is_lowest ? "set format x '%h'\n" + label : "set format x ''\nunset xlabel\n");
}

std::string common_label(const Chart& chart, const PrintLayout& layout) {
  if (layout.boxes.front().is_alone_in_row) return "";
  return "set label " + gnuplot_quoted(chart.x_label) + " noenhanced at screen 0.5, screen " +
         readable(10.0 / layout.height, 4) + " center\n";
}

/// Upper end of the vertical axis: the limit of the axis if it has one, else a little above all
/// curves and bands.
double upper_end(const ChartPanel& panel) {
  if (!std::isnan(panel.axis.high)) return panel.axis.high;
  double greatest = panel.axis.low;
  const auto include = [&](double value) {
    if (std::isfinite(value)) greatest = std::max(greatest, value);
  };
  for (const Curve& curve : panel.curves) {
    std::ranges::for_each(curve.values, include);
  }
  for (const Band& band : panel.bands) include(band.upper);
  return greatest > panel.axis.low ? 1.05 * greatest : panel.axis.low + 1.0;
}

/// Ticks at distances of 1, 2 or 5 times a power of ten that leave room for the numbers.
std::string linear_ticks(double from, double to, double pixels) {
  const double least = (on_axis(to) - on_axis(from)) * 26.0 / pixels;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  const double steps = least / power;
  const double step = power * (steps <= 1.0 ? 1.0 : steps <= 2.0 ? 2.0 : steps <= 5.0 ? 5.0 : 10.0);
  return "set ytics nomirror " + command_number(step) + "\n";
}

/// Commands for the names left and the notes right of the rows of strips.
std::string strip_axis(const ChartPanel& panel) {
  std::vector<std::string> names;
  std::string notes;
  const auto note = [&](const std::string& text, const std::string& at) {
    notes += "set label " + gnuplot_quoted(text) + " noenhanced at graph 1," + at + "\n";
  };
  note(panel.strips.notes, "graph 1 left offset 0.8,0.8");
  for (std::size_t r = 0; r < panel.strips.rows.size(); ++r) {
    const ChartStrips::Row& row = panel.strips.rows[r];
    note(row.note, "first " + std::to_string(r) + " left offset 0.8,0");
    names.push_back(row.name);
  }
  return "set ytics nomirror " + named_ticks(names) +
         "\nset ytics scale 0 noenhanced\nset border 1\nunset grid\n" +
         range("y", panel.axis.low, panel.axis.high) + "unset label\nset label " +
         gnuplot_quoted(panel.label) + " noenhanced at graph 0,1 left offset 0,0.8\n" + notes;
}

std::string vertical_axis(const ChartPanel& panel, const PanelBox& box) {
  if (!panel.strips.rows.empty()) return strip_axis(panel);
  if (has_names(panel)) {
    return "unset logscale y\nset ytics nomirror " + named_ticks(panel.names) +
           "\nset ytics scale 0 noenhanced\nunset ylabel\n" +
           range("y", panel.axis.low, panel.axis.high);
  }
  const ChartAxis& axis = panel.axis;
  const bool is_plain = !axis.logarithmic || (axis.low >= 0.01 && axis.high < 1e4);
  const double to = upper_end(panel);
  const std::string label = gnuplot_quoted(panel.label) + " noenhanced";
  return std::string(axis.logarithmic ? "set" : "unset") + " logscale y\n" +
         (axis.logarithmic ? "set ytics nomirror autofreq\n"
                           : linear_ticks(axis.low, to, box.bottom - box.top)) +
         "set format y '" + (is_plain ? "%h" : "10^{%T}") + "'\n" + range("y", axis.low, to) +
         "unset label\n" +
         (box.has_heading
              ? "unset ylabel\nset label " + label + " at graph 0,1 left offset -3,0.8\n"
              : "set ylabel " + label + " offset 1.2,0\n");
}

std::string place(const PanelBox& box, double width, double height) {
  const auto margin = [](const char* side, double share) {
    return std::string("set ") + side + "margin at screen " + readable(share, 6) + "\n";
  };
  return margin("l", box.left / width) + margin("r", box.right / width) +
         margin("t", 1.0 - box.top / height) + margin("b", 1.0 - box.bottom / height);
}

struct LegendEntry {
  std::string how, words;
};

/// The entries of the legend: bands, then cells that no heading names or, on maps, the kinds of
/// marks.
std::vector<LegendEntry> legend_of(const Chart& chart) {
  std::vector<LegendEntry> entries;
  const auto add = [&](const std::string& how, const std::string& words) {
    if (words.empty() || std::ranges::find(entries, words, &LegendEntry::words) != entries.end())
      return;
    entries.push_back({how, words});
  };
  for (const Band& band : chart.panels.front().bands) add(band_style(), band.legend);
  for (const ChartPanel& panel : chart.panels) {
    for (const auto& curve : panel.curves) {
      if (curve.legend != panel.cell) add(curve_style(curve.style), curve.legend);
    }
    for (const ChartMarks& marks : panel.marks) {
      if (has_names(panel)) continue;
      const bool is_named = panel.cell == marks.cell;
      if (chart.is_map || !is_named) add(mark_style(marks), chart.is_map ? marks.name : marks.cell);
    }
  }
  return entries;
}

std::size_t legend_columns(const std::vector<LegendEntry>& entries, std::size_t width) {
  std::size_t longest = 8;
  for (const LegendEntry& entry : entries) longest = std::max(longest, entry.words.size());
  return std::clamp<std::size_t>((width - 90) / (8 * longest + 68), 1, entries.size());
}

/// An empty plot across the whole drawing, for the legend: a panel's legend is no wider than the
/// panel.
std::string legend_plot(const std::vector<LegendEntry>& entries, std::size_t columns,
                        const PanelBox& box, double width, double height) {
  std::string script = "unset border\nunset tics\nunset grid\n" + place(box, width, height) +
                       "set key inside left top horizontal Left reverse maxcols " +
                       std::to_string(columns) + "\nplot [0:1] [0:1] ";
  for (const auto& [how, words] : entries) {
    script += "keyentry with " + how + " title " + gnuplot_quoted(words) + ", \\\n  ";
  }
  return script + "NaN notitle\n";
}

/// Makes commands that place objects in pixels from the upper left corner of the drawing.
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

/// Commands that draw the colour scale of strips above them instead of a legend. It is aligned with
/// the strips in `box` if there is room in a drawing of this size [px].
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

}  // namespace

GnuplotChart gnuplot_chart(const Chart& chart, std::size_t width) {
  constexpr std::size_t kLegendRow = 23;  // [px] height of a row of the legend
  const std::vector<LegendEntry> legend = legend_of(chart);
  const std::size_t columns = legend.empty() ? 1 : legend_columns(legend, width);
  const std::size_t legend_height =
      has_strips(chart)
          ? kStripKeyHeight
          : (legend.size() + columns - 1) / columns * kLegendRow + (legend.empty() ? 0 : 8);
  const auto w = static_cast<double>(width);
  const PrintLayout layout = print_layout(chart, w, static_cast<double>(legend_height));
  GnuplotChart drawn{"", "set style ellipse units xx\nset multiplot\n",
                     static_cast<std::size_t>(layout.height)};
  if (!legend.empty()) {
    const PanelBox top{40.0, w - 10.0, 4.0, static_cast<double>(legend_height)};
    drawn.commands += legend_plot(legend, columns, top, w, layout.height);
  }
  const std::string key = has_strips(chart) ? strip_key(chart.panels.front().strips,
                                                        layout.boxes.front(), w, layout.height)
                                            : "";
  drawn.commands += kPanelStyle;
  for (std::size_t k = 0; k < layout.boxes.size(); ++k) {
    const ChartPanel& panel = chart.panels[k / layout.views];
    const PanelWriter plots(chart, k / layout.views);
    if (k % layout.views == 0) drawn.numbers += plots.numbers();
    drawn.commands += place(layout.boxes[k], w, layout.height) +
                      horizontal_axis(chart, layout.boxes[k]) +
                      vertical_axis(panel, layout.boxes[k]) +
                      (k == 0 ? common_label(chart, layout) + key : "unset object\n") + "plot " +
                      plots.commands() + "\n";
  }
  drawn.commands += "unset multiplot\n";
  return drawn;
}

namespace {

/// Settings common to all figures. The page shows black parts in the colour of the text.
constexpr const char* kStyle = R"(set encoding utf8
set datafile separator comma
set datafile columnheaders
set key noenhanced samplen 1.6 width 1
)";

/// Makes the whole script. It draws the figure for the page and for print, with as much room for a
/// row of the legend in both.
std::string script_of(const Figure& figure) {
  const GnuplotChart drawn = gnuplot_chart(figure.chart, figure.width);
  const std::string size = std::to_string(figure.width) + "," + std::to_string(drawn.height);
  const auto centimetres = [](std::size_t pixels) {
    return readable(static_cast<double>(pixels) * 0.02, 3) + "cm";
  };
  return "# Drawn again by: gnuplot " + figure.name + ".gp\n" + kStyle + "set key spacing 1.15\n" +
         drawn.numbers + "set terminal svg size " + size +
         " dynamic background rgb '#ffffff' font 'sans-serif,13' linewidth 1.3\nset output '" +
         figure.name + ".svg'\n" + drawn.commands +
         "unset output\nreset\nset terminal pdfcairo size " + centimetres(figure.width) + "," +
         centimetres(drawn.height) + " font 'sans,8' linewidth 1.3\nset output '" + figure.name +
         ".pdf'\n" + kStyle + "set key spacing 1.9\n" + drawn.commands + "unset output\n";
}

}  // namespace

void draw(std::span<const Figure* const> figures, const std::filesystem::path& directory) {
  make_directory(directory / "data");
  make_directory(directory / "figures");
  std::vector<std::string> scripts;
  for (const Figure* figure : figures) {
    for (const FigureData& data : figure->data) {
      write_csv(data.frame, directory / "data" / data.name);
    }
    write_text(directory / "figures" / scripts.emplace_back(figure->name + ".gp"),
               script_of(*figure));
  }
  run_gnuplot(directory / "figures", scripts);
}

}  // namespace montecarta::analysis
