// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/make_plan.hpp"

#include "analysis/data/study_settings.hpp"
#include "experiments/study/setting.hpp"
#include "experiments/text/words.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace montecarta::experiments {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string plan_complaint(const std::string& text) {
  try {
    make_plan(parsed(text));
  } catch (const StudyError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Plan, CarriesTheStudy) {
  const StudyPlan plan = make_plan(parsed(kGoodStudy), RunRange{5, 9});
  EXPECT_EQ(plan.name, "trial");
  EXPECT_EQ(plan.runs, 20U);
  EXPECT_EQ(plan.runs_here(), 4U);
  ASSERT_EQ(plan.cells.size(), 1U);
  EXPECT_EQ(plan.cells[0].landmarks, 35U);
  EXPECT_NE(plan.cells[0].make_filter(), nullptr);
  EXPECT_TRUE(plan.columns.covariance);
  EXPECT_FALSE(plan.columns.map);
  EXPECT_EQ(plan.drives->itinerary().landmarks.size(), 35U);
}

TEST(Plan, OfTheResolvedTextIsTheSame) {
  const std::string text =
      with("[cells]",
           "sigma_range = 0.3\nmax_range = 20\n[record]\ncolumns = pose\nrate = scan\n[cells]");
  const StudyPlan plan = make_plan(parsed(text));
  const StudyPlan again = make_plan(parsed(plan.resolved_text));
  EXPECT_EQ(again.resolved_text, plan.resolved_text);
  EXPECT_EQ(again.scenario, plan.scenario);
  EXPECT_EQ(again.cells[0].label, plan.cells[0].label);
  EXPECT_EQ(again.cells[0].long_name, plan.cells[0].long_name);
  EXPECT_TRUE(again.columns.scans_only);
  Drive drive;
  Drive drive_again;
  plan.drives->generate(3, drive);
  again.drives->generate(3, drive_again);
  EXPECT_TRUE(std::ranges::equal(
      drive.detections, drive_again.detections,
      [](const Detection& a, const Detection& b) { return a[0] == b[0] && a[1] == b[1]; }));
}

TEST(Plan, RefusesSettingsThatDoNotFitTogether) {
  EXPECT_THAT(plan_complaint(with("[cells]", "scan_rate = 7\n[cells]")),
              HasSubstr("trial.ini:6: scan_rate does not divide control_rate"));
  EXPECT_THAT(plan_complaint(with("[cells]", "scan_rate = 80\n[cells]")),
              HasSubstr("scan_rate does not divide"));
  EXPECT_THAT(plan_complaint(with("[cells]", "[association]\nnew_gate_sigma = 1\n[cells]")),
              HasSubstr("new_gate_sigma is below gate_sigma"));
  EXPECT_THAT(plan_complaint(with("[cells]", "waypoint_radius = 0.001\n[cells]")),
              HasSubstr("is not reached within 0.001 m"));
}

TEST(Plan, RefusesJointEstimatesThatNoCellHas) {
  const std::string record = "[record]\ncolumns = pose, joint\n[cells]";
  EXPECT_THAT(plan_complaint(with("[cells]\ncell = ekf_slam", record + "\ncell = fastslam2")),
              HasSubstr("trial.ini:7: joint (none of the cells' filters"));
  const StudyPlan plan = make_plan(parsed(with("[cells]", record) + "cell = fastslam2\n"));
  EXPECT_TRUE(plan.cells[0].joint);
  EXPECT_FALSE(plan.cells[1].joint);
  EXPECT_EQ(plan.columns.joint_scans, 16u);
  EXPECT_THAT(plan.resolved_text, HasSubstr("joint_scans = 16"));
  EXPECT_THAT(plan_complaint(with("[cells]", "[association]\nkind = nearest\n" + record) +
                             "cell = smoother\n"),
              HasSubstr("nobody knows which landmark of a map is which"));
}

TEST(Plan, KeepsTheMarginInTheTextWhereItIsNotTheUsualOne) {
  const StudyPlan plan = make_plan(parsed(with("[scenario]", "within = 1.25\n[scenario]")));
  EXPECT_EQ(margin_in(plan.resolved_text), 1.25);
  EXPECT_THAT(make_plan(parsed(kGoodStudy)).resolved_text, Not(HasSubstr("within")));
  EXPECT_EQ(kUsualWithin, to_text(kUsualMargin));
}

TEST(Plan, HasAMixtureWhereTheEstimatesHaveOne) {
  std::string cells = "cell = fastslam1\ncell = marginal\n";
  for (const char* filter : {"fastslam2", "ufastslam", "srcd", "srcd_aided", "srcd_pf"}) {
    cells += "cell = " + std::string(filter) + "\ncell = " + filter + " weights=ratio\n";
  }
  for (const char* mode : {"unbiased", "as_printed", "prior", "shared"}) {
    cells += "cell = de_srcd mode=" + std::string(mode) + "\n";
  }
  const StudyPlan plan = make_plan(parsed(kGoodStudy + cells));
  const std::vector<Detection> scan{{5.0, 0.3, 0}, {7.0, -0.4, 1}};
  std::size_t mixtures = 0;
  for (const Cell& cell : plan.cells) {
    const auto filter = cell.make_filter();
    filter->start({});
    for (std::uint32_t step = 0; step < 4; ++step) {
      const StepContext context(1, 0, step, Parallel::serial());
      filter->predict(context, {1.0, 0.1}, 0.1);
      EXPECT_EQ(filter->estimate().mixture.has_value(), cell.mixture) << cell.long_name;
      filter->update(context, scan);
      EXPECT_EQ(filter->estimate().mixture.has_value(), cell.mixture) << cell.long_name;
    }
    mixtures += cell.mixture ? 1 : 0;
  }
  EXPECT_EQ(mixtures, 7U);
}

TEST(Plan, CanScanAsThePublicSimulatorDoes) {
  const StudyPlan plan =
      make_plan(parsed(with("[cells]", "scan_rate = 4.444444444444445\n[cells]")));
  EXPECT_EQ(plan.drives->itinerary().scan_step[0], 8U) << "every ninth step (EQUATIONS 1)";
}

}  // namespace
}  // namespace montecarta::experiments
