// SPDX-License-Identifier: BSD-3-Clause
// Errors of the estimates, cost of a run, and numbers of arithmetic fallbacks.
#include "analysis/run/measured_run.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/boxes.hpp"
#include "analysis/study/cell_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

/// Mean over the scans of a run. Of imported estimates some may be missing; of our own filters a
/// mean with an estimate that is not finite is none.
double over_scans(const MeasuredRun& run, std::span<const double> values) {
  return run.rows.error.components() > 0 ? mean_of_finite(values) : mean_of(values);
}

double mean_root(const MeasuredRun& run, std::span<const double> squares) {
  std::vector<double> roots(squares.size());
  std::ranges::transform(squares, roots.begin(), [](double square) { return std::sqrt(square); });
  return over_scans(run, roots);
}

double position_mse(const MeasuredRun& run) {
  return over_scans(run, run.metrics.squared_position());
}

double position_mean(const MeasuredRun& run) {
  return mean_root(run, run.metrics.squared_position());
}

/// Mean error in a quarter of the scans, the first of which is quarter 0, by its squares.
template <std::size_t kQuarter>
double mean_root_in_quarter(const MeasuredRun& run, std::span<const double> squares) {
  const std::size_t from = kQuarter * squares.size() / 4;
  const std::size_t to = (kQuarter + 1) * squares.size() / 4;
  return mean_root(run, squares.subspan(from, to - from));
}

template <std::size_t kQuarter>
double position_mean_in_quarter(const MeasuredRun& run) {
  return mean_root_in_quarter<kQuarter>(run, run.metrics.squared_position());
}

template <std::size_t kQuarter>
double heading_mean_in_quarter(const MeasuredRun& run) {
  return mean_root_in_quarter<kQuarter>(run, run.metrics.squared_heading());
}

double position_median(const MeasuredRun& run) {
  std::vector<double> squares = run.metrics.squared_position();
  if (run.rows.error.components() > 0)
    std::erase_if(squares, [](double square) { return !std::isfinite(square); });
  return squares.empty() ? kNaN : std::sqrt(median_of(std::move(squares)));
}

double heading_mse(const MeasuredRun& run) {
  return over_scans(run, run.metrics.squared_heading());
}

constexpr Score kErrorsScores[] = {
    {"position_rmse", "m", "position RMSE",
     [](const MeasuredRun& run) { return std::sqrt(position_mse(run)); }},
    {"position_mse", "m2", "position MSE", position_mse},
    {"position_error", "m", "mean position error", position_mean},
    {"position_error_variance_over_time", "m2", "variance of the position error over time",
     [](const MeasuredRun& run) {
       const double mean = position_mean(run);
       return position_mse(run) - mean * mean;
     }},
    {"position_error_median", "m", "median position error over time", position_median},
    {"position_error_quarter1", "m", "mean position error in the first quarter of the scans",
     position_mean_in_quarter<0>},
    {"position_error_quarter2", "m", "mean position error in the second quarter of the scans",
     position_mean_in_quarter<1>},
    {"position_error_quarter3", "m", "mean position error in the third quarter of the scans",
     position_mean_in_quarter<2>},
    {"position_error_quarter4", "m", "mean position error in the last quarter of the scans",
     position_mean_in_quarter<3>},
    {"heading_rmse", "rad", "heading RMSE",
     [](const MeasuredRun& run) { return std::sqrt(heading_mse(run)); }},
    {"heading_mse", "rad2", "heading MSE", heading_mse},
    {"heading_error", "rad", "mean absolute heading error",
     [](const MeasuredRun& run) { return mean_root(run, run.metrics.squared_heading()); }},
    {"heading_error_quarter1", "rad",
     "mean absolute heading error in the first quarter of the scans", heading_mean_in_quarter<0>},
    {"heading_error_quarter2", "rad",
     "mean absolute heading error in the second quarter of the scans", heading_mean_in_quarter<1>},
    {"heading_error_quarter3", "rad",
     "mean absolute heading error in the third quarter of the scans", heading_mean_in_quarter<2>},
    {"heading_error_quarter4", "rad",
     "mean absolute heading error in the last quarter of the scans", heading_mean_in_quarter<3>},
};

constexpr ScanSeries kErrorsSeries[] = {
    {"position_rmse", "m", [](const MeasuredRun& run) { return run.metrics.squared_position(); },
     true},
    {"heading_rmse", "rad", [](const MeasuredRun& run) { return run.metrics.squared_heading(); },
     true},
};

/// A panel with the cells' curves and the Cramer-Rao bound or, if there is none, the linearised
/// reference.
Panel error_panel(const StudyAnalysis& study, const std::string& name, const std::string& label,
                  const CellValues& values_of, const std::vector<double>& bound) {
  Panel panel{name, label, cell_curves(study, values_of), {}, Scale::from_zero};
  if (!bound.empty() && !panel.curves.empty()) {
    panel.curves.push_back({study.bound.is_bound ? "Cramer-Rao bound" : "linearised reference",
                            kReferenceStyle, bound});
  }
  return panel;
}

Figure rmse_figure(const StudyAnalysis& study) {
  Figure figure = figure_of("rmse");
  const CellValues position = [](const CellAnalysis& cell) {
    return cell.over_time("position_rmse");
  };
  const CellValues heading = [](const CellAnalysis& cell) {
    return scaled(cell.over_time("heading_rmse"), 180.0 / kPi);
  };
  if (!study.bound.empty()) {
    figure.sentence += " " + prose("errors", study.bound.is_bound ? "bound" : "reference");
  }
  add_panels(
      {error_panel(study, "rmse_position", "position RMSE [m]", position, study.bound.position),
       error_panel(study, "rmse_heading", "heading RMSE [deg]", heading,
                   scaled(study.bound.heading, 180.0 / kPi))},
      study.times, figure);
  return figure;
}

/// The figure with boxes of a score of the runs, times `factor`.
Figure error_boxes(const StudyAnalysis& study, Figure figure, const char* score, const char* label,
                   double factor) {
  std::vector<BoxRow> rows;
  for (std::size_t i = 0; i < study.cells.size(); ++i) {
    const CellAnalysis& cell = study.cells[i];
    rows.push_back({cell.label, i, scaled(cell.scores.column(score), factor)});
  }
  add_boxes(rows, label, figure);
  return figure;
}

std::vector<Figure> errors_figures(const StudyAnalysis& study) {
  return {rmse_figure(study),
          error_boxes(study, figure_of("position_boxes"), "position_rmse",
                      "position RMSE of a run [m]", 1.0),
          error_boxes(study, figure_of("heading_boxes"), "heading_rmse",
                      "heading RMSE of a run [deg]", 180.0 / kPi)};
}

}  // namespace

Metric errors_metric() {
  return {.scores = kErrorsScores, .scan_series = kErrorsSeries, .figures = errors_figures};
}

}  // namespace montecarta::analysis
