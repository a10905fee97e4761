// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/tuning/scores.hpp"

#include "experiments/study/known_filters.hpp"
#include "experiments/tuning/noise_factors.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::experiments {
namespace {

Study study_of_association(const std::string& kind) {
  return parse_study(
      "[study]\nname = tuned\nruns = 2\n[scenario]\nworld = small_loop\n[association]\nkind = " +
          kind + "\n[cells]\ncell = ekf_slam sensor_noise=0.5\n",
      "tuned.ini", ".", known_filters());
}

TEST(InnovationScore, GivesDetectionsThatAreLeftOutTheSameDensityWithAnyNoise) {
  const Study study = study_of_association("nearest");
  const CellSpec& half = study.cells.front();
  const CellSpec whole = with_noise(half, {.motion = 1.0, .sensor = 2.0}, "whole");
  const std::vector<Detection> scan(3);  // one matched, two left out
  // By EQUATIONS (17.2) the filter's density of each is 4 times as large with half the noise.
  const ScanReport of_whole{.log_likelihood = -5.0, .nis_dof = 2};
  const ScanReport of_half{.log_likelihood = -5.0 + 2.0 * std::log(4.0), .nis_dof = 2};
  EXPECT_EQ(InnovationScore(study, whole)(of_whole, scan), 5.0);
  EXPECT_DOUBLE_EQ(InnovationScore(study, half)(of_half, scan), 5.0);
}

TEST(InnovationScore, IsTheLikelihoodWhereIdentitiesAreKnown) {
  const Study study = study_of_association("known");
  const std::vector<Detection> scan(3);
  EXPECT_EQ(InnovationScore(study, study.cells.front())({.log_likelihood = -5.0}, scan), 5.0);
}

TEST(NoiseFactors, MultiplyWhatTheCellAssumes) {
  const Study study = study_of_association("known");
  const CellSpec tuned =
      with_noise(study.cells.front(), {.motion = 1.23456, .sensor = 2.0}, "tuned");
  EXPECT_EQ(mismatch_of(tuned, "motion_noise"), 1.235);
  EXPECT_EQ(mismatch_of(tuned, "sensor_noise"), 1.0);
  EXPECT_EQ(tuned.label, "tuned");
  EXPECT_THROW(with_noise(study.cells.front(), {.motion = 1e5}, "far"), StudyError);
}

}  // namespace
}  // namespace montecarta::experiments
