// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/calibration.hpp"
#include "tests/analysis/reported.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace montecarta::analysis {
namespace {

/// A cell of which the Gaussian was asked at the end of the run, and no particles are stored.
StudyAnalysis without_particles() {
  StudyAnalysis study;
  study.times = {0.2, 0.4};
  study.runs_here = 100;
  CellAnalysis cell;
  cell.label = "ekf_slam";
  PitHistogram histogram{"x", "Gaussian", 0.4, 0, {}};
  histogram.test.counts.assign(10, 10);
  cell.findings.put(Calibrations{histogram});
  study.cells = {cell};
  return study;
}

TEST(CalibrationFigures, DrawNothingOfParticlesThatAreNotStored) {
  EXPECT_FALSE(reported_figure(without_particles(), "calibration").data.empty());
  EXPECT_TRUE(reported_figure(without_particles(), "ranks").data.empty());
}

}  // namespace
}  // namespace montecarta::analysis
