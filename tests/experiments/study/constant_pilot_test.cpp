// SPDX-License-Identifier: BSD-3-Clause
// scenario.pilot = constant: controls that are held.
#include "experiments/study/make_plan.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace montecarta::experiments {
namespace {

struct HeldDrive {
  Itinerary itinerary;
  Drive drive;
};

HeldDrive held(std::vector<std::string> more, std::uint64_t run = 0) {
  more.insert(more.end(), {"scenario.pilot=constant", "scenario.speed=2"});
  const StudyPlan plan = make_plan(parsed(kGoodStudy, more), {}, ExternalPrograms::refused);
  HeldDrive found{plan.drives->itinerary(), {}};
  plan.drives->generate(run, found.drive);
  return found;
}

TEST(ConstantPilot, IsNoPartOfTheTextOfAStudyWithoutIt) {
  const auto usual = resolved_settings(parsed(kGoodStudy));
  EXPECT_FALSE(usual.contains("scenario.pilot"));
  EXPECT_FALSE(usual.contains("scenario.drive_time"));
  const auto matched = resolved_settings(parsed(kGoodStudy, {"scenario.noise=matched"}));
  EXPECT_EQ(matched.at("scenario.pilot"), "closed_loop");
  const Study constant = parsed(kGoodStudy, {"scenario.pilot=constant"});
  EXPECT_EQ(resolved_text(parsed(resolved_text(constant))), resolved_text(constant));
  EXPECT_EQ(resolved_settings(constant).at("scenario.drive_time"), "60");
  EXPECT_EQ(resolved_settings(constant).at("scenario.constant_steer_deg"), "0");
}

TEST(ConstantPilot, RefusesControlsThatItsVehicleDoesNotHave) {
  EXPECT_THAT(
      complaint(kGoodStudy, {"scenario.pilot=constant", "scenario.constant_yaw_rate_deg=3"}),
      HasSubstr("constant_yaw_rate_deg does not apply to scenario.vehicle = front_axle"));
  EXPECT_THAT(complaint(kGoodStudy, {"scenario.drive_time=3"}),
              HasSubstr("drive_time does not apply to scenario.pilot = closed_loop"));
  EXPECT_THAT(complaint_of([] { held({"scenario.drive_time=0.1"}); }),
              HasSubstr("ends before the first scan"));
  EXPECT_THAT(complaint_of([] {
                held({"scenario.drive_time=1e8", "scenario.control_rate=1000"});
              }),
              AllOf(HasSubstr("scenario.drive_time"), Not(HasSubstr("scenario.loops"))));
}

TEST(ConstantPilot, DrivesStraightOn) {
  const HeldDrive straight = held({"scenario.drive_time=20"});
  EXPECT_EQ(straight.itinerary.steps(), 800U);
  EXPECT_EQ(straight.itinerary.scans(), 100U);
  const Pose& end = straight.drive.truth.back();
  EXPECT_NEAR(end.x, 40.0, 1e-9);
  EXPECT_NEAR(end.y, 0.0, 1e-9);
}

TEST(ConstantPilot, DrivesACircle) {
  for (const char* vehicle : {"differential_drive", "omnidirectional"}) {
    const HeldDrive circle = held({"scenario.vehicle=" + std::string(vehicle),
                                   "scenario.drive_time=10", "scenario.constant_yaw_rate_deg=36"});
    const double radius = 2.0 / (36.0 / 180.0 * kPi);
    const Pose& end = circle.drive.truth.back();
    EXPECT_NEAR(std::hypot(end.x, end.y), 0.0, 1e-9) << vehicle;
    const Pose& half = circle.drive.truth[circle.itinerary.steps() / 2 - 1];
    EXPECT_NEAR(half.y, 2.0 * radius, 1e-9) << vehicle;
  }
  const HeldDrive car = held({"scenario.constant_steer_deg=-20", "scenario.drive_time=30"});
  for (const Control& control : car.drive.controls) EXPECT_NE(control[1], 0.0);
  EXPECT_LT(car.drive.truth[200].y, 0.0);
}

/// With matched noise the filter is given the controls that are held, and the vehicle strays.
TEST(ConstantPilot, IsGivenToFiltersAsItIs) {
  const HeldDrive noisy = held({"scenario.noise=matched", "scenario.drive_time=20"});
  for (const Control& control : noisy.drive.controls) {
    EXPECT_EQ(control[0], 2.0);
    EXPECT_EQ(control[1], 0.0);
  }
  EXPECT_GT(std::abs(noisy.drive.truth.back().y), 1e-3);
}

}  // namespace
}  // namespace montecarta::experiments
