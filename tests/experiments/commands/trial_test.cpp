// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/trial.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace montecarta::experiments
