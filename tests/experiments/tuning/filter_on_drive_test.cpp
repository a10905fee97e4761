// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/tuning/filter_on_drive.hpp"

#include "tests/doubles/filter_with_fixes.hpp"

#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

/// The fixes that a filter is given of a drive with one at every second scan.
std::vector<PositionFix> fixes_given(std::size_t interval) {
  StudyPlan plan;
  plan.drives = std::make_shared<ScriptedDrives>(40);  // 10 scans
  Drive drive = drive_with_fixes(*plan.drives);
  std::vector<PositionFix> taken;
  FilterWithFixes filter(taken);
  EXPECT_TRUE(run_filter({plan, 0, drive, 10, interval}, filter, [](auto&&...) {}));
  return taken;
}

TEST(FilterOnDrive, TakesTheFixesOfTheScansThatItIsGiven) {
  const std::vector<PositionFix> all{
      {1.0, -1.0}, {3.0, -3.0}, {5.0, -5.0}, {7.0, -7.0}, {9.0, -9.0}};
  EXPECT_EQ(fixes_given(1), all);
  EXPECT_EQ(fixes_given(3), std::vector<PositionFix>({{5.0, -5.0}}));
}

}  // namespace
}  // namespace montecarta::experiments
