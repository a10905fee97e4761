// SPDX-License-Identifier: BSD-3-Clause
// Errors beside the reported deviations, and the share of bias in the NEES (STATISTICS 8).
#include "analysis/metrics/error_anatomy.hpp"

#include "analysis/metrics/cell_report.hpp"
#include "analysis/metrics/lineages.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/numbers/angle.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr double kFewestRunsOfMoments = 4.0;
constexpr double kEnvelope = 3.0;  // standard deviations
constexpr std::size_t kMostEnvelopeRows = 6;

/// One scan's moments over runs.
struct Moment {
  Eigen::Vector3d bias;
  Eigen::Matrix3d squares;     ///< mean squared error
  Eigen::Matrix3d covariance;  ///< believed
  double n;
};

/// Equation (8.1); NaN where runs are too few or the mean covariance is singular.
double bias_share(const Moment& m) {
  const Eigen::LLT<Eigen::Matrix3d> P(m.covariance);
  if (m.n < kFewestRunsOfMoments || P.info() != Eigen::Success) return kNaN;
  const double nees = P.solve(m.squares).trace();
  const double by_bias = m.bias.dot(P.solve(m.bias));
  const double by_chance = (nees - by_bias) / (m.n - 1.0);  // of a mean over n errors without bias
  return std::clamp((by_bias - by_chance) / nees, 0.0, 1.0);
}

class ErrorAnatomyOverRuns final : public MergedSums<ErrorAnatomyOverRuns> {
 public:
  explicit ErrorAnatomyOverRuns(const RunCriteria& criteria) : moments_(criteria.times.size()) {}
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
    return std::tuple(added(&ErrorAnatomyOverRuns::moments_),
                      of_first_run(&ErrorAnatomyOverRuns::first_));
  }

 private:
  std::optional<ErrorTrace> first_;
  ErrorMoments moments_;
};

const std::vector<ResultNumber<ErrorAnatomy>> kBiasQuantities = {
    {"bias_share", "1", &ErrorAnatomy::mean_bias_share, "bias", percent}};

void error_anatomy_series(const CellAnalysis& cell, std::vector<Frame::Column>& all) {
  const ErrorAnatomy* anatomy = cell.find<ErrorAnatomy>();
  if (anatomy == nullptr) return;
  for (std::size_t c = 0; c < kErrorComponents.size(); ++c) {
    const std::string name = kErrorComponents[c];
    const std::string units = name == "heading" ? "rad" : "m";
    all.push_back({"rms_error_" + name, units, anatomy->happened[c]});
    all.push_back({"believed_deviation_" + name, units, anatomy->believed[c]});
    all.push_back({"mean_error_" + name, units, anatomy->bias[c]});
  }
  all.push_back({"bias_share", "1", anatomy->bias_share});
}

std::vector<TextTable::Entry> why_row(const CellAnalysis& cell) {
  std::vector<TextTable::Entry> row;
  const ErrorAnatomy* anatomy = cell.find<ErrorAnatomy>();
  if (anatomy == nullptr) return row;
  add_entries(kBiasQuantities, *anatomy, 0.0, row);
  row.push_back({"Monte Carlo share", percent(cell.get<LineageSummary>().monte_carlo_share)});
  return row;
}

/// The error of one component with its envelope; angles in degrees.
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

/// A row of panels, forward, left and heading, for each of the first cells.
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

Figure bias_figure(const StudyAnalysis& study) {
  return cell_figure(
      study, figure_of("bias"), {"bias_share", "bias in ANEES [%]", {}, {}, Scale::percent},
      [](const CellAnalysis& cell) { return scaled(cell.get<ErrorAnatomy>().bias_share, 100.0); });
}

std::vector<Section> error_anatomy_sections(const StudyAnalysis& study) {
  const CellNumber bias = [](const CellAnalysis& cell) {
    return cell.get<ErrorAnatomy>().mean_bias_share;
  };
  return table_section(
      section_of("error_anatomy", {{"bias", range_over_cells(study, bias, percent)}}),
      cell_table(study, why_row));
}

std::vector<Figure> error_anatomy_figures(const StudyAnalysis& study) {
  return {envelope_figure(study), bias_figure(study)};
}

}  // namespace

ErrorTrace error_trace(std::uint64_t run, std::span<const Eigen::Vector3d> errors,
                       std::span<const Eigen::Matrix3d> covariances) {
  ErrorTrace trace;
  trace.run = run;
  for (std::size_t s = 0; s < errors.size(); ++s) {
    for (int c = 0; c < 3; ++c) {
      const auto component = static_cast<std::size_t>(c);
      trace.error[component].push_back(errors[s](c));
      trace.deviation[component].push_back(std::sqrt(covariances[s](c, c)));
    }
  }
  return trace;
}

void ErrorMoments::add(std::span<const Eigen::Vector3d> errors,
                       std::span<const Eigen::Matrix3d> covariances) {
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    if (!errors[s].allFinite() || !covariances[s].allFinite()) continue;
    scans_[s].n += 1.0;
    scans_[s].error += errors[s];
    scans_[s].squares += errors[s] * errors[s].transpose();
    scans_[s].covariance += covariances[s];
  }
}

ErrorAnatomy ErrorMoments::result() const {
  ErrorAnatomy anatomy;
  for (const Sums& sums : scans_) {
    const Moment m{sums.error / sums.n, sums.squares / sums.n, sums.covariance / sums.n, sums.n};
    for (int c = 0; c < 3; ++c) {
      const auto component = static_cast<std::size_t>(c);
      anatomy.happened[component].push_back(std::sqrt(m.squares(c, c)));
      anatomy.believed[component].push_back(std::sqrt(m.covariance(c, c)));
      anatomy.bias[component].push_back(m.bias(c));
    }
    anatomy.bias_share.push_back(bias_share(m));
  }
  anatomy.mean_bias_share = mean_of_finite(anatomy.bias_share);
  return anatomy;
}

Metric error_anatomy_metric() {
  return {.sums = make_sums<ErrorAnatomyOverRuns>,
          .add_numbers = numbers_by(kBiasQuantities),
          .add_series = error_anatomy_series,
          .sections = error_anatomy_sections,
          .figures = error_anatomy_figures};
}

}  // namespace montecarta::analysis
