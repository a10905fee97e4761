// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/particle_curves.hpp"

#include "analysis/metrics/cell_panels.hpp"
#include "analysis/metrics/reference_report.hpp"
#include "analysis/metrics/reference_scores.hpp"

#include <algorithm>
#include <limits>

namespace montecarta::analysis {
namespace {

ParticleCurve::Point point_of(const CellAnalysis& cell) {
  const ReferenceAnalysis& leading = cell.get<ReferenceAnalyses>().front();
  return {cell.particles, cell.complete, leading.over_runs(&ReferenceScores::rms),
          leading.over_runs(&ReferenceScores::aligned_rms)};
}

FigureData data_of(const ParticleCurve& curve) {
  FigureData data{"rms_" + curve.legend + ".csv", {"particles", "runs"}, {}};
  for (const std::string what : {"raw", "aligned"}) {
    for (const std::string which : {"mean", "standard error", "median", "least", "greatest"}) {
      data.headings.push_back(what + " RMS, " + which + " [m]");
    }
  }
  for (const auto& point : curve.points) {
    std::vector<double> row = {static_cast<double>(point.particles),
                               static_cast<double>(point.runs)};
    for (const Spread* spread : {&point.raw, &point.aligned}) {
      row.insert(row.end(), {spread->summary.mean, spread->summary.standard_error(), spread->median,
                             spread->least, spread->greatest});
    }
    data.rows.push_back(std::move(row));
  }
  return data;
}

/// The numbers of particles that there are.
std::vector<std::size_t> particle_numbers(const std::vector<ParticleCurve>& curves) {
  std::vector<std::size_t> numbers;
  for (const ParticleCurve& curve : curves) {
    for (const auto& point : curve.points) numbers.push_back(point.particles);
  }
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

/// An empty chart over them, with some room at both ends.
Chart empty_chart(const std::vector<std::size_t>& numbers) {
  Chart chart{"particles",
              0.8 * static_cast<double>(numbers.front()),
              1.25 * static_cast<double>(numbers.back()),
              {},
              true};
  chart.columns = 2;
  chart.least = 300;
  chart.aspect = 0.65;
  return chart;
}

/// Common to both panels: from zero, or logarithmic where runs differ by more than two decades.
ChartAxis error_axis(const std::vector<ParticleCurve>& curves,
                     const std::optional<std::array<double, 2>>& baseline) {
  double least = std::numeric_limits<double>::infinity(), greatest = 0.0;
  const auto include = [&](double value) {
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  };
  for (const ParticleCurve& curve : curves) {
    for (const auto& point : curve.points) {
      for (const Spread* spread : {&point.raw, &point.aligned}) {
        include(spread->least);
        include(spread->greatest);
      }
    }
  }
  if (baseline) std::ranges::for_each(*baseline, include);
  const bool wide = greatest > 100.0 * least;
  return {wide, wide ? 0.8 * least : 0.0, 1.1 * greatest};
}

ChartPanel chart_panel(const std::vector<ParticleCurve>& curves,
                       Spread ParticleCurve::Point::*error, const std::optional<double>& baseline,
                       const std::vector<std::size_t>& numbers, ChartPanel panel) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  panel.x.assign(numbers.begin(), numbers.end());
  for (const ParticleCurve& curve : curves) {
    const std::vector<double> nothing(numbers.size(), kNone);
    auto& drawn = panel.curves.emplace_back();
    drawn = {curve.legend, curve.style, nothing, nothing, nothing};
    for (const ParticleCurve::Point& point : curve.points) {
      const auto at = static_cast<std::size_t>(std::ranges::lower_bound(numbers, point.particles) -
                                               numbers.begin());
      const Spread& spread = point.*error;
      drawn.values[at] = spread.summary.mean;
      drawn.least[at] = spread.least;
      drawn.greatest[at] = spread.greatest;
    }
  }
  if (baseline) {
    panel.curves.push_back(
        {"EKF-SLAM", kReferenceStyle, std::vector<double>(numbers.size(), *baseline)});
  }
  return panel;
}

}  // namespace

std::vector<ParticleCurve> particle_curves(const StudyAnalysis& study) {
  std::vector<ParticleCurve> curves;
  if (study.references.empty() || study.references.front().fixes == 0) return curves;
  const std::vector<std::string> labels = filter_labels(study);
  for (std::size_t i = 0; i < labels.size(); ++i) curves.push_back({labels[i], i, {}});
  for (const CellAnalysis& cell : study.cells) {
    if (cell.particles == 0 || cell.complete == 0) continue;
    const std::string label = label_without_particles(cell);
    std::ranges::find(curves, label, &ParticleCurve::legend)->points.push_back(point_of(cell));
  }
  std::erase_if(curves, [](const ParticleCurve& curve) { return curve.points.empty(); });
  for (ParticleCurve& curve : curves) {
    std::ranges::sort(curve.points, {}, &ParticleCurve::Point::particles);
  }
  const bool several = std::ranges::any_of(
      curves, [](const ParticleCurve& curve) { return curve.points.size() > 1; });
  return several ? curves : std::vector<ParticleCurve>{};
}

std::optional<std::array<double, 2>> baseline_errors(const StudyAnalysis& study) {
  const CellAnalysis* baseline = baseline_of(study);
  if (baseline == nullptr) return std::nullopt;
  const ReferenceAnalysis& leading = baseline->get<ReferenceAnalyses>().front();
  return std::array{leading.over_runs(&ReferenceScores::rms).summary.mean,
                    leading.over_runs(&ReferenceScores::aligned_rms).summary.mean};
}

void draw_particle_curves(const std::vector<ParticleCurve>& curves,
                          const std::optional<std::array<double, 2>>& baseline, Figure& figure) {
  for (const ParticleCurve& curve : curves) figure.data.push_back(data_of(curve));
  const auto base = [&](std::size_t which) {
    return baseline ? std::optional((*baseline)[which]) : std::nullopt;
  };
  const std::vector<std::size_t> numbers = particle_numbers(curves);
  const ChartAxis axis = error_axis(curves, baseline);
  figure.chart = empty_chart(numbers);
  figure.chart.x_ticks.assign(numbers.begin(), numbers.end());
  figure.chart.panels = {chart_panel(curves, &ParticleCurve::Point::raw, base(0), numbers,
                                     {"RMS distance as it stands [m]", axis, {}, {}, {}}),
                         chart_panel(curves, &ParticleCurve::Point::aligned, base(1), numbers,
                                     {"aligned [m]", axis, {}, {}, {}})};
}

}  // namespace montecarta::analysis
