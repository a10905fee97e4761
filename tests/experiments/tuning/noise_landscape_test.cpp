// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/tuning/noise_landscape.hpp"

#include "experiments/tuning/filter_on_drive.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

TEST(NoiseLandscape, ScoresTheScansThatAreJudged) {
  const Study study = parsed(kGoodStudy, {"study.judge_from=20"});
  const StudyPlan plan = make_plan(study);
  const Itinerary& itinerary = plan.drives->itinerary();
  Drive drive;
  plan.drives->generate(0, drive);
  ScoreSum late, all;
  const std::size_t scans = itinerary.scans();
  run_filter({plan, 0, drive, scans}, *plan.cells[0].make_filter(),
             [&](std::size_t scan, const SlamFilter& filter, bool /*is_given*/) {
               const std::uint32_t step = itinerary.scan_step[scan];
               const double score = pose_score(filter.estimate(), drive.truth[step]);
               if (std::isnan(score)) return;
               all.add(score);
               if (itinerary.step_time[step] >= 20.0) late.add(score);
             });
  NoiseLandscape landscape(study, study.cells[0], TuningScore::truth, Parallel::serial());
  landscape.compute(std::array{LatticePoint{}}, 1);
  EXPECT_EQ(landscape.mean({}, 1, {0}), late.mean());
  EXPECT_NE(late.mean(), all.mean());
}

}  // namespace
}  // namespace montecarta::experiments
