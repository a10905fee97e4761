// SPDX-License-Identifier: BSD-3-Clause
// Where the truth lies in what filters hold for possible; only where the noise is matched.
#include "analysis/metrics/calibration_figure.hpp"
#include "analysis/metrics/calibration_table.hpp"
#include "analysis/metrics/cell_calibration.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"

namespace montecarta {
namespace {

class CalibrationOverRuns final : public MetricSums {
 public:
  explicit CalibrationOverRuns(const Yardsticks& sticks) : sticks_(&sticks) {}
  void add(const MeasuredRun& run) override {
    if (sticks_->calibrates) calibration_.add(run.pits);
  }
  void put(CellAnalysis& cell) override {
    cell.findings.put(calibration_.result(sticks_->times, sticks_->level));
  }

 private:
  const Yardsticks* sticks_;
  CalibrationSums calibration_;
};

std::vector<Section> calibration_sections(const StudyAnalysis& study) {
  if (!has_calibration(study)) return {};
  Section section{"calibration", "Calibration"};
  section.add("calibration", calibration_table(study));
  section.add(calibration_notes(study));
  for (const Figure& figure : calibration_figures(study)) section.add(figure);
  return {section};
}

}  // namespace

Metric calibration_metric() {
  return {.sums = [](const Yardsticks& sticks) -> std::unique_ptr<MetricSums> {
            return std::make_unique<CalibrationOverRuns>(sticks);
          },
          .sections = calibration_sections};
}

}  // namespace montecarta
