// SPDX-License-Identifier: BSD-3-Clause
// Errors beside the standard deviations that the filter reports (STATISTICS 8).
#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_report.hpp"
#include "analysis/study/error_moments.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr double kEnvelope = 3.0;  // half width of an envelope in standard deviations

constexpr std::size_t kMostEnvelopeRows = 6;

class ErrorsOverRuns final : public MergedSums<ErrorsOverRuns> {
 public:
  explicit ErrorsOverRuns(const RunCriteria& criteria) : moments_(criteria.times.size()) {}
  void add(const MeasuredRun& run) override {
    const RunMetrics& metrics = run.metrics;
    if (metrics.covariances().empty()) return;
    if (!first_) first_ = error_trace(run.rows.run, metrics.errors(), metrics.covariances());
    moments_.add(metrics.errors(), metrics.covariances());
  }
  void put(CellAnalysis& cell) override {
    if (!first_) return;
    cell.findings.put(moments_.result());
    cell.findings.put(*first_);
  }
  static constexpr auto parts() {
    return std::tuple(added(&ErrorsOverRuns::moments_), of_first_run(&ErrorsOverRuns::first_));
  }

 private:
  std::optional<ErrorTrace> first_;
  ErrorMoments moments_;
};

void error_series(const CellAnalysis& cell, std::vector<Frame::Column>& all) {
  const ErrorsOverTime* errors = cell.find<ErrorsOverTime>();
  if (errors == nullptr) return;
  for (std::size_t c = 0; c < kErrorComponents.size(); ++c) {
    const std::string name = kErrorComponents[c];
    const std::string units = name == "heading" ? "rad" : "m";
    all.push_back({"rms_error_" + name, units, errors->rms[c]});
    all.push_back({"believed_deviation_" + name, units, errors->believed[c]});
    all.push_back({"mean_error_" + name, units, errors->mean[c]});
  }
}

/// Makes a panel with the error of one component and its envelope; angles are in degrees.
Panel envelope_panel(const CellAnalysis& cell, std::size_t style, std::size_t component) {
  const ErrorTrace& trace = *cell.find<ErrorTrace>();
  const std::string name = kErrorComponents[component];
  const bool is_angle = name == "heading";
  const double factor = is_angle ? 180.0 / kPi : 1.0;
  Panel panel{"error_" + name + "_" + cell.label,
              name + (is_angle ? " [deg], " : " [m], "),
              {},
              {},
              Scale::around_zero};
  panel.label += cell.label;
  panel.curves.push_back({cell.label, style, scaled(trace.error[component], factor),
                          scaled(trace.deviation[component], factor * kEnvelope)});
  return panel;
}

/// Makes a figure with a row of panels, forward, left and heading, for each of the first cells.
Figure envelope_figure(const StudyAnalysis& study) {
  Figure figure = figure_of("error_envelopes");
  std::vector<Panel> panels;
  std::vector<std::string> cells;
  for (std::size_t i = 0; i < study.cells.size() && cells.size() < kMostEnvelopeRows; ++i) {
    if (!study.cells[i].find<ErrorTrace>()) continue;
    cells.push_back(study.cells[i].label);
    for (std::size_t c = 0; c < kErrorComponents.size(); ++c)
      panels.push_back(envelope_panel(study.cells[i], i, c));
  }
  add_panels(panels, study.times, figure);
  for (std::size_t p = 0; p < figure.chart.panels.size(); ++p)
    figure.chart.panels[p].cell = cells[p / kErrorComponents.size()];
  figure.chart.columns = kErrorComponents.size();
  figure.chart.least = 220;
  figure.chart.aspect = 0.5;
  return figure;
}

std::vector<Figure> error_envelopes_figures(const StudyAnalysis& study) {
  return {envelope_figure(study)};
}

}  // namespace

Metric error_envelopes_metric() {
  return {.sums = make_sums<ErrorsOverRuns>,
          .add_series = error_series,
          .figures = error_envelopes_figures};
}

}  // namespace montecarta::analysis
