// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/check.hpp"
#include "tests/doubles/filter_with_fixes.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace montecarta::experiments {
namespace {

/// Drives of 100, 20 and 60 steps, a run each or (`own` = 0) the first one in every run.
class ThreeLengths final : public DriveSource {
 public:
  explicit ThreeLengths(std::size_t own) : own_(own) {
    for (const std::size_t steps : {100U, 20U, 60U}) all_.emplace_back().step_time.resize(steps);
  }
  const Itinerary& itinerary() const override { return all_.front(); }
  std::size_t own_drives() const override { return own_; }
  const Itinerary& itinerary_of(std::uint64_t run) const override {
    return all_.at(own_ == 0 ? 0 : run);
  }
  void generate(std::uint64_t /*run*/, Drive& /*drive*/) const override {}

 private:
  std::size_t own_;
  std::vector<Itinerary> all_;
};

TEST(Trial, WeighsDrivesByTheirSteps) {
  StudyPlan plan;
  plan.last_run = 3;
  plan.drives = std::make_shared<ThreeLengths>(3);
  EXPECT_DOUBLE_EQ(runs_like_the_first(plan), 1.8);
  plan.first_run = 1;
  EXPECT_DOUBLE_EQ(runs_like_the_first(plan), 4.0);
  plan.drives = std::make_shared<ThreeLengths>(0);
  EXPECT_DOUBLE_EQ(runs_like_the_first(plan), 2.0);
}

/// Starts as slowly as a program, and holds `bytes`.
class SlowStarter final : public ScriptedFilter {
 public:
  explicit SlowStarter(std::size_t bytes) : ScriptedFilter({}), held_(bytes, 'x') {}
  void predict(const StepContext& context, const Control& control, double duration) override {
    if (!is_begun_) std::this_thread::sleep_for(std::chrono::milliseconds(300));
    is_begun_ = true;
    ScriptedFilter::predict(context, control, duration);
  }

 private:
  bool is_begun_ = false;
  std::string held_;
};

Trial trial_of_filter(std::size_t bytes) {
  StudyPlan plan;
  plan.drives = std::make_shared<ScriptedDrives>(200);
  Drive drive;
  plan.drives->generate(0, drive);
  Cell cell;
  cell.make_filter = [bytes] { return std::make_unique<SlowStarter>(bytes); };
  return trial_of(cell, plan, drive).value();
}

// The start is one of the process, not of each run: 200 of them would be a minute.
TEST(Trial, LeavesOutTheStartOfAProgram) { EXPECT_LT(trial_of_filter(0).seconds, 10.0); }

TEST(Trial, GivesTheFilterItsFixes) {
  StudyPlan plan;
  plan.drives = std::make_shared<ScriptedDrives>(40);
  std::vector<PositionFix> taken;
  Cell cell;
  cell.make_filter = [&taken] { return std::make_unique<FilterWithFixes>(taken); };
  ASSERT_TRUE(trial_of(cell, plan, drive_with_fixes(*plan.drives)));
  EXPECT_EQ(taken.size(), 5U);
}

TEST(Trial, MeasuresWhatAFilterHolds) {
  EXPECT_GT(trial_of_filter(200'000'000).bytes, 190e6);
  EXPECT_LT(trial_of_filter(200'000'000).bytes, 250e6);
}

}  // namespace
}  // namespace montecarta::experiments
