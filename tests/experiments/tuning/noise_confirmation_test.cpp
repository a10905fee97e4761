// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/tuning/noise_confirmation.hpp"

#include "tests/doubles/scripted_study.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <gmock/gmock.h>

namespace montecarta::experiments {
namespace {

constexpr std::uint64_t kRunsToConfirm = 19;

/// Both cells to confirm, of 10 scans, which the filters of `make` drive.
StudyPlan plan_to_confirm(std::vector<std::function<std::unique_ptr<SlamFilter>()>> make) {
  StudyPlan plan;
  plan.runs = plan.last_run = kRunsToConfirm;
  plan.drives = std::make_shared<ScriptedDrives>(40);
  for (auto& one : make) plan.cells.emplace_back().make_filter = std::move(one);
  return plan;
}

auto failing_in(std::uint64_t run) {
  return [run] {
    return std::make_unique<ScriptedFilter>(ScriptedFilter::Script{.mishap = Mishap{.run = run}});
  };
}

TEST(TuningConfirmation, CountsTheRunsInWhichAFilterFails) {
  const StudyPlan plan = plan_to_confirm({failing_in(3), [] {
                                            return std::make_unique<ScriptedFilter>(
                                                ScriptedFilter::Script{.mishap = Mishap{}});
                                          }});
  const TuningConfirmation found = confirm_on_runs(parsed(kGoodStudy), plan, Parallel::serial());
  EXPECT_EQ(found.failed_before, 1U);
  EXPECT_EQ(found.failed_after, kRunsToConfirm);
  EXPECT_THAT(tuning_notes(TuningResult(), found),
              testing::Contains(testing::HasSubstr("failed in 1 with the old noise and in 19")));
}

/// A filter that is lost until its fifth scan.
class LostAtFirst final : public ScriptedFilter {
 public:
  LostAtFirst() : ScriptedFilter({}) {}
  void update(const StepContext& context, Scan scan) override {
    ++scans_;
    ScriptedFilter::update(context, scan);
  }
  PoseEstimate estimate() const override {
    PoseEstimate estimate = ScriptedFilter::estimate();
    if (scans_ < 5) estimate.mixture->mean.x += 1e3;
    return estimate;
  }

 private:
  int scans_ = 0;
};

TEST(TuningConfirmation, LeavesOutTheScansThatAreNotJudged) {
  const auto right = [] { return std::make_unique<ScriptedFilter>(ScriptedFilter::Script{}); };
  const StudyPlan plan = plan_to_confirm({right, [] { return std::make_unique<LostAtFirst>(); }});
  const auto confirmed = [&](const std::string& from) {
    return confirm_on_runs(parsed(kGoodStudy, {"study.judge_from=" + from}), plan,
                           Parallel::serial());
  };
  EXPECT_GT(confirmed("0.4").covering_path, 1e4);  // scans are at 0.1, 0.2, ... s
  EXPECT_LT(confirmed("0.45").covering_path, 1.0);
  EXPECT_LT(confirmed("0.4").gain.mean, -1e3);
  EXPECT_EQ(confirmed("0.45").gain.mean, 0.0);
}

}  // namespace
}  // namespace montecarta::experiments
