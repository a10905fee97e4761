// SPDX-License-Identifier: BSD-3-Clause
// What a study may say of vehicles.
#include "experiments/recordings/log_csv.hpp"
#include "experiments/study/make_drives.hpp"
#include "experiments/study/make_plan.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <gmock/gmock.h>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kRobot =
    with("world = web_loop ", "world = web_loop\nvehicle = differential_drive ");

TEST(VehicleStudy, ARobotHasItsOwnSettingsAndNoneOfACar) {
  const std::string text = resolved_text(parsed(kRobot));
  EXPECT_THAT(text, AllOf(HasSubstr("integration = arc\n"), HasSubstr("sigma_yaw_rate_deg = 3\n"),
                          HasSubstr("turn_on_spot_deg = 45\n"), Not(HasSubstr("wheelbase")),
                          Not(HasSubstr("steer"))));
  const std::string car = resolved_text(parsed(kGoodStudy));
  EXPECT_THAT(car, AllOf(HasSubstr("wheelbase = 4\n"), Not(HasSubstr("yaw_rate")),
                         Not(HasSubstr("integration"))));
}

TEST(VehicleStudy, TheResolvedTextIsTheSameStudy) {
  const auto overrides = {"scenario.vehicle=differential_drive", "scenario.alpha_3=0.01",
                          "belief.integration=euler", "belief.alpha_1=0.2"};
  const std::string text = resolved_text(parsed(kGoodStudy, {overrides.begin(), overrides.end()}));
  EXPECT_EQ(resolved_text(parsed(text)), text);
  EXPECT_THAT(text, HasSubstr("alpha_3 = 0.01\n"));
}

TEST(VehicleStudy, SettingsReachTheVehicleAndItsNoise) {
  const Study study = parsed(
      kRobot, {"scenario.yaw_rate_limit_deg=180", "scenario.alpha_4=0.1",
               "scenario.sigma_yaw_rate_deg=18", "belief.alpha_4=0", "scenario.integration=euler"});
  const auto vehicle = std::get<DifferentialDrive>(vehicle_of(study.settings, "scenario"));
  EXPECT_DOUBLE_EQ(vehicle.yaw_rate_limit, kPi);
  EXPECT_EQ(vehicle.integration, Integration::euler);
  EXPECT_EQ(std::get<DifferentialDrive>(vehicle_of(study.settings, "belief")).integration,
            Integration::euler);
  const ControlNoise noise = control_noise_of(study.settings, "scenario");
  EXPECT_DOUBLE_EQ(noise.sigma[1], 0.1 * kPi);
  EXPECT_EQ(noise.alpha[3], 0.1);
  EXPECT_EQ(control_noise_of(study.settings, "belief").alpha[3], 0.0);
}

TEST(VehicleStudy, WhatIsOfAnotherVehicleIsRefused) {
  EXPECT_THAT(complaint(kRobot, {"scenario.wheelbase=2"}),
              AllOf(HasSubstr("scenario.wheelbase says nothing of a vehicle differential_drive"),
                    HasSubstr("front_axle, rear_wheel")));
  EXPECT_THAT(complaint(kRobot, {"belief.sigma_steer_deg=2"}),
              HasSubstr("belief.sigma_steer_deg says nothing of a vehicle differential_drive"));
}

TEST(VehicleStudy, ThePilotIsOfMatchedNoise) {
  EXPECT_THAT(complaint(kRobot, {"scenario.noise=measured-control", "scenario.pilot=open_loop"}),
              HasSubstr("scenario.pilot says nothing of a noise measured-control"));
  const Study study = parsed(kRobot, {"scenario.noise=matched", "scenario.pilot=open_loop"});
  EXPECT_EQ(study.settings.text("scenario", "pilot"), "open_loop");
  EXPECT_THAT(resolved_text(study), HasSubstr("pilot = open_loop\n"));
}

TEST(VehicleStudy, AFilterThatBelievesInOtherControlsIsRefused) {
  const auto plan = [](const Study& study) {
    return complaint_of([&] { make_plan(study, std::nullopt, ExternalPrograms::refused); });
  };
  EXPECT_THAT(plan(parsed(kRobot, {"belief.vehicle=front_axle"})),
              AllOf(HasSubstr("controlled by speed, steer (the drive has speed, yaw_rate)")));
  EXPECT_EQ(plan(parsed(kGoodStudy, {"belief.vehicle=rear_wheel"})), "nothing");
}

TEST(VehicleStudy, NoiseGrowsByTheSquareOfAMismatch) {
  const std::string text = kRobot + "cell = dead_reckoning\ncell = dead_reckoning motion_noise=3\n";
  const StudyPlan plan =
      make_plan(parsed(text, {"scenario.alpha_1=0.1"}), std::nullopt, ExternalPrograms::refused);
  std::vector<Eigen::Matrix3d> covariances;
  for (const std::size_t cell : {1, 2}) {
    const auto filter = plan.cells[cell].make_filter();
    filter->start(Pose());
    filter->predict(StepContext(1, 0, 0, Parallel::serial()), {3.0, 0.5}, 0.1);
    covariances.push_back(filter->estimate().spread.covariance);
  }
  EXPECT_TRUE(covariances[1].isApprox(9.0 * covariances[0], 1e-12));
  EXPECT_NEAR(covariances[0](0, 0), 0.01 * (0.09 + 0.1 * 9.0), 1e-4);
}

/// A log of a robot that turns on the spot, as a folder.
class RobotLog : public testing::Test {
 protected:
  RobotLog() {
    write_text(folder_ / "start.csv", "time_s,x_m,y_m,heading_rad\n0,0,0,0\n");
    write_text(folder_ / "odometry.csv",
               "time_s,speed_mps,yaw_rate_radps\n0,0.5,0\n1,0,1.5\n2,0,0\n");
    write_text(folder_ / "detections.csv", "time_s,range_m,bearing_rad\n1.5,5,0.2\n2.5,5,0.1\n");
    write_text(folder_ / "reference.csv", "time_s,x_m,y_m\n0,0,0\n3,0.5,0\n");
  }
  Study study(const std::string& belief) const {
    return parsed("[study]\nname = robot\nruns = 1\n[scenario]\nkind = log\npath = " +
                  folder_.path().string() + "\n[belief]\n" + belief +
                  "\nsigma_range = 0.1\nsigma_bearing_deg = 1\n[cells]\ncell = ekf_slam\n");
  }
  ScratchFolder folder_;
};

TEST_F(RobotLog, IsDrivenAsItWasRecorded) {
  const auto drives = drives_of(
      study("vehicle = differential_drive\nsigma_speed = 0.1\nsigma_yaw_rate_deg = 3"), 1);
  Drive drive;
  drives->generate(0, drive);
  const std::size_t moving = drives->itinerary().moving_controls;
  EXPECT_EQ(moving, 2U);
  ASSERT_EQ(drive.controls.size(), 4U);
  EXPECT_EQ(drive.controls[1][1], 1.5);
  EXPECT_FALSE(drive.controls[1].stands(moving));
  EXPECT_TRUE(drive.controls[3].stands(moving));
}

TEST_F(RobotLog, NeedsABeliefInThatVehicle) {
  EXPECT_THAT(complaint_of([this] {
                drives_of(study("wheelbase = 1\nsigma_speed = 0.1\nsigma_steer_deg = 3"), 1);
              }),
              HasSubstr("controlled by speed, steer (the drive has speed, yaw_rate)"));
  EXPECT_THAT(complaint_of([this] { study("vehicle = differential_drive\nsigma_speed = 0.1"); }),
              HasSubstr("sigma_yaw_rate_deg is missing"));
}

TEST_F(RobotLog, IsWrittenAsItWasRead) {
  const DriveLog log = read_log_csv(folder_.path());
  write_log_csv(log, folder_ / "copy");
  const DriveLog copy = read_log_csv(folder_ / "copy");
  EXPECT_EQ(copy.controls.data(), log.controls.data());
  ASSERT_EQ(copy.odometry.size(), 3U);
  EXPECT_EQ(copy.odometry[1].control.values, log.odometry[1].control.values);
}

TEST_F(RobotLog, OfAYawRateInDegreesIsRefused) {
  write_text(folder_ / "odometry.csv", "time_s,speed_mps,yaw_rate_radps\n0,0.5,0\n1,0,180\n");
  EXPECT_THAT(complaint_of([this] { read_log_csv(folder_.path()); }),
              HasSubstr("record 2: yaw rate 180 (radians per second, at most 100)"));
}

}  // namespace
}  // namespace montecarta::experiments
