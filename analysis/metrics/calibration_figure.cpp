// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/calibration_figure.hpp"

#include "analysis/metrics/cell_calibration.hpp"
#include "analysis/output/number_text.hpp"

#include <algorithm>

namespace montecarta {
namespace {

constexpr std::size_t kMostRows = 8;

/// A histogram that is drawn.
struct DrawnHistogram {
  std::size_t cell = 0;
  std::string label;
  const PitHistogram* histogram = nullptr;
};

/// Those of one cell at the end of the run.
std::vector<DrawnHistogram> last_of(const StudyAnalysis& study, std::size_t c,
                                    const std::string& by) {
  std::vector<DrawnHistogram> drawn;
  const CellAnalysis& cell = study.cells[c];
  for (const PitHistogram& one : cell.get<Calibrations>()) {
    if (one.by == by && one.time == study.times.back()) drawn.push_back({c, cell.label, &one});
  }
  return drawn;
}

/// Share of runs in every bin, as a multiple of what is expected.
FigureData data_of(const std::string& name, const DrawnHistogram& drawn) {
  FigureData data{name, {"from", "to", "count / expected", "lower", "upper"}, {}};
  const Uniformity& test = drawn.histogram->test;
  double all = 0.0;
  for (const std::size_t n : test.counts) all += static_cast<double>(n);
  const auto bins = static_cast<double>(test.counts.size());
  const double expected = std::max(all, 1.0) / bins;  // without values all bins are empty
  for (std::size_t b = 0; b < test.counts.size(); ++b) {
    data.rows.push_back({static_cast<double>(b) / bins, static_cast<double>(b + 1) / bins,
                         static_cast<double>(test.counts[b]) / expected,
                         static_cast<double>(test.band.lower) / expected,
                         static_cast<double>(test.band.upper) / expected});
  }
  return data;
}

/// From the rows of data_of(). The band is that of all bins.
ChartPanel chart_panel(const DrawnHistogram& drawn, const FigureData& data) {
  ChartPanel panel{drawn.label + ", " + drawn.histogram->quantity + ": " +
                       in_words(drawn.histogram->test.verdict),
                   {false, 0.0, 0.0},
                   {},
                   {},
                   {{"band of a calibrated filter", data.rows.front()[3], data.rows.front()[4]}},
                   drawn.label};
  ChartMarks& bars = panel.marks.emplace_back();
  bars.cell = drawn.label;
  bars.name = drawn.histogram->quantity;
  bars.style = drawn.cell;
  bars.shape = ChartMarks::Shape::boxes;
  bars.facts = {{"from", {}}, {"to", {}}, {"count / expected", {}}};
  double highest = std::max(1.0, panel.bands.front().upper);
  for (const auto& row : data.rows) {
    bars.x.push_back(0.5 * (row[0] + row[1]));
    bars.y.push_back(0.5 * row[2]);
    bars.width.push_back(row[1] - row[0]);
    bars.height.push_back(row[2]);
    for (std::size_t f = 0; f < bars.facts.size(); ++f) bars.facts[f].values.push_back(row[f]);
    highest = std::max(highest, row[2]);
  }
  panel.axis.high = 1.1 * highest;
  return panel;
}

Chart empty_chart(std::size_t columns) {
  Chart chart{"from the lower (0) to the upper end (1)", 0.0, 1.0, {}};
  chart.columns = columns;
  chart.least = 150;
  chart.aspect = 0.5;
  return chart;
}

Figure figure_of(const StudyAnalysis& study, const std::string& by, Figure figure) {
  std::vector<std::vector<DrawnHistogram>> rows;
  for (std::size_t c = 0; c < study.cells.size() && rows.size() < kMostRows; ++c) {
    if (auto row = last_of(study, c, by); !row.empty()) rows.push_back(std::move(row));
  }
  if (rows.empty()) return figure;
  std::size_t columns = 0;
  for (const auto& row : rows) columns = std::max(columns, row.size());
  figure.chart = empty_chart(columns);
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string name =
          figure.name + "_" + row[c].label + "_" + std::to_string(c + 1) + ".csv";
      figure.data.push_back(data_of(name, row[c]));
      figure.chart.panels.push_back(chart_panel(row[c], figure.data.back()));
    }
  }
  return figure;
}

}  // namespace

std::vector<Figure> calibration_figures(const StudyAnalysis& study) {
  const std::string reading =
      " Bars are shares of runs, 1 is what they should be; bars that all stay in the grey band "
      "belong to a calibrated filter. A valley: the filter is too sure of itself; a hill: too "
      "cautious; a slope: it is off to one side.";
  Figure gaussian{"calibration", "Does the truth lie where the filter says?", ""};
  gaussian.sentence =
      "Where the truth lies in the Gaussian of the filter at the end of the run, from its lower "
      "(0) "
      "to its upper end (1)." +
      reading;
  Figure particles{"ranks", "Does the truth lie among the particles?", ""};
  particles.sentence =
      "Which share of the weighted particles lies below the truth at the end of the run." + reading;
  return {figure_of(study, "Gaussian", gaussian), figure_of(study, "particles", particles)};
}

}  // namespace montecarta
