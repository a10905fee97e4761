// SPDX-License-Identifier: BSD-3-Clause
// What a study may say of sensors.
#include "experiments/recordings/log_csv.hpp"
#include "experiments/study/make_drives.hpp"
#include "experiments/study/make_plan.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <gmock/gmock.h>

#include <cmath>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kWorld = "[study]\nname = s\nruns = 1\n[scenario]\nworld = web_loop\n";
const std::string kKnown = "[association]\nkind = known\n";

std::string of_cell(const std::string& filter) {
  return kWorld + kKnown + "[cells]\ncell = " + filter + "\n";
}

TEST(SensorStudy, ASensorHasItsOwnNoiseAndNoOther) {
  const std::string text = resolved_text(parsed(
      of_cell("ekf_slam"), {"scenario.sensor=position", "scenario.sigma_position_left=0.3"}));
  EXPECT_THAT(text,
              AllOf(HasSubstr("sensor = position\n"), HasSubstr("sigma_position_left = 0.3\n"),
                    HasSubstr("sigma_position_forward = 0.1\n"), Not(HasSubstr("sigma_range")),
                    Not(HasSubstr("sigma_bearing"))));
  EXPECT_EQ(resolved_text(parsed(text)), text);
  EXPECT_THAT(resolved_text(parsed(of_cell("ekf_slam"))),
              AllOf(HasSubstr("sigma_range"), Not(HasSubstr("sensor =")), Not(HasSubstr("mount")),
                    Not(HasSubstr("min_range")), Not(HasSubstr("sigma_position"))));
  EXPECT_THAT(
      complaint(of_cell("ekf_slam"), {"scenario.sensor=bearing_only", "scenario.sigma_range=1"}),
      AllOf(HasSubstr("scenario.sigma_range says nothing of a sensor bearing_only"),
            HasSubstr("range_bearing, range_only")));
}

TEST(SensorStudy, BeliefsMayMountItElsewhere) {
  const Study study = parsed(
      of_cell("ekf_slam"),
      {"scenario.mount_forward=0.5", "scenario.mount_turn_deg=90", "belief.mount_left=-0.1"});
  const Mounting is = sensor_of(study.settings, "scenario").mounting;
  const Mounting believed = sensor_of(study.settings, "belief").mounting;
  EXPECT_EQ(is.forward, 0.5);
  EXPECT_EQ(is.left, 0.0);
  EXPECT_DOUBLE_EQ(believed.turn, kPi / 2);
  EXPECT_EQ(believed.forward, 0.5);
  EXPECT_EQ(believed.left, -0.1);
}

TEST(SensorStudy, WhatAFilterDoesNotTakeIsRefused) {
  EXPECT_THAT(complaint(of_cell("marginal"), {"scenario.sensor=range_only"}),
              AllOf(HasSubstr("marginal takes no sensor range_only (it takes range_bearing)"),
                    HasSubstr("ekf_slam, riekf_slam")));
  EXPECT_THAT(complaint(of_cell("de_srcd"), {"scenario.mount_left=1"}),
              AllOf(HasSubstr("de_srcd takes no sensor that is mounted elsewhere"),
                    HasSubstr("fastslam1, fastslam2, ufastslam, srcd")));
  EXPECT_THAT(
      complaint(of_cell("ekf_slam"), {"scenario.sensor=bearing_only", "association.kind=nearest"}),
      HasSubstr("association.kind = nearest with bearing_only"));
  EXPECT_EQ(
      complaint(of_cell("ekf_slam"), {"scenario.sensor=position", "association.kind=nearest"}),
      "nothing");
  EXPECT_EQ(complaint(of_cell("dead_reckoning"),
                      {"scenario.sensor=bearing_only", "association.kind=nearest"}),
            "nothing");
}

TEST(SensorStudy, ParticleFiltersTakeEverySensorButNeedToKnowWhatTheyDelay) {
  for (const char* filter : {"fastslam1", "fastslam2", "ufastslam", "srcd"}) {
    for (const std::string& sensor : sensor_names()) {
      const std::string kind = "scenario.sensor=" + sensor;
      EXPECT_EQ(complaint(of_cell(filter), {kind, "scenario.mount_left=1"}), "nothing");
      const std::string refusal =
          complaint(of_cell(filter), {kind, "association.kind=nearest", "scenario.mount_left=1"});
      if (fixes_landmark(*sensor_named(sensor))) {
        EXPECT_EQ(refusal, "nothing") << filter << ", " << sensor;
      } else {
        EXPECT_THAT(refusal, AllOf(HasSubstr("association.kind = nearest with " + sensor),
                                   HasSubstr("set association.kind = known")));
      }
    }
  }
}

TEST(SensorStudy, ABeliefInOtherDetectionsIsRefused) {
  const Study study = parsed(of_cell("ekf_slam"), {"belief.sensor=position"});
  EXPECT_THAT(complaint_of([&] { drives_of(study, 1); }),
              HasSubstr("belief.sensor = position has other detections than the drive"));
}

TEST(SensorStudy, GatesAcceptAsOftenWhateverTheDimensionOfADetection) {
  for (const std::string& sensor : sensor_names()) {
    Study study = parsed(of_cell("dead_reckoning"),
                         {"scenario.sensor=" + sensor, "association.gate_sigma=2.5"});
    AssociationSettings given;
    FilterKind asking = *study.cells[0].filter;
    asking.make = [&given, make = asking.make](const FilterSetup& setup) {
      given = setup.association;
      return make(setup);
    };
    study.cells[0].filter = &asking;
    make_plan(study).cells[0].make_filter();
    const auto dimension = static_cast<double>(components_of(*sensor_named(sensor)).size());
    const double accepted = std::erf(2.5 / std::sqrt(2.0));
    EXPECT_NEAR(given.gate, quantile(boost::math::chi_squared(dimension), accepted), 1e-9)
        << sensor;
  }
}

/// A log of bearings, as a folder.
class BearingLog : public testing::Test {
 protected:
  BearingLog() {
    write_text(folder_ / "start.csv", "time_s,x_m,y_m,heading_rad\n0,0,0,0\n");
    write_text(folder_ / "odometry.csv", "time_s,speed_mps,steer_rad\n0,0.5,0\n2,0,0\n");
    write_text(folder_ / "detections.csv",
               "time_s,bearing_rad,identity\n0.5,,\n1.5,0.2,3\n1.5,-0.5,\n");
    write_text(folder_ / "reference.csv", "time_s,x_m,y_m\n0,0,0\n3,0.5,0\n");
  }
  ScratchFolder folder_;
};

TEST_F(BearingLog, IsWrittenAsItWasRead) {
  const DriveLog log = read_log_csv(folder_.path());
  ASSERT_EQ(log.components.size(), 1U);
  EXPECT_EQ(log.components[0], Quantity::bearing);
  EXPECT_TRUE(log.scans[0].detections.empty());
  EXPECT_EQ(log.scans[1].detections[0].identity, 3);
  write_log_csv(log, folder_ / "copy");
  const DriveLog copy = read_log_csv(folder_ / "copy");
  EXPECT_EQ(copy.components.data(), log.components.data());
  ASSERT_EQ(copy.scans.size(), 2U);
  EXPECT_EQ(copy.scans[1].detections[1].values, log.scans[1].detections[1].values);
}

TEST_F(BearingLog, NeedsABeliefInThatSensor) {
  const auto drives = [&](const std::string& belief) {
    const Study study = parsed("[study]\nname = b\nruns = 1\n[scenario]\nkind = log\npath = " +
                               folder_.path().string() + "\n" + kKnown +
                               "[belief]\nwheelbase = 1\nsigma_speed = 0.1\n"
                               "sigma_steer_deg = 3\nsigma_bearing_deg = 1\n" +
                               belief + "[cells]\ncell = ekf_slam\n");
    drives_of(study, 1);
  };
  EXPECT_THAT(complaint_of([&] { drives("sigma_range = 1\n"); }),
              HasSubstr("set belief.sensor to the sensor of the drive"));
  EXPECT_EQ(complaint_of([&] { drives("sensor = bearing_only\n"); }), "nothing");
}

TEST_F(BearingLog, InDegreesIsRefused) {
  write_text(folder_ / "detections.csv", "time_s,bearing_rad\n1.5,45\n");
  EXPECT_THAT(complaint_of([this] { read_log_csv(folder_.path()); }),
              HasSubstr("record 1: bearing 45 (radians relative to the heading)"));
}

TEST(SensorStudy, ObservabilityIsOfFiltersThatTellItAndSensorsThatFixLandmarks) {
  const auto refusal = [](const char* filter, const char* sensor) {
    const std::string chosen = std::string("scenario.sensor=") + sensor;
    const Study study = parsed(of_cell(filter), {chosen, "record.columns=pose, observability"});
    return complaint_of([&] { make_plan(study); });
  };
  EXPECT_THAT(refusal("dead_reckoning", "range_bearing"),
              HasSubstr("observability (no cell tells"));
  EXPECT_THAT(refusal("ekf_slam", "bearing_only"), HasSubstr("observability (no cell tells"));
  EXPECT_EQ(refusal("ekf_slam", "position"), "nothing");
  EXPECT_EQ(refusal("fej_ekf_slam", "range_bearing"), "nothing");
}

TEST(SensorStudy, SomethingIsInReach) {
  EXPECT_THAT(
      engine::complaint_of([] {
        drives_of(parsed(of_cell("ekf_slam"), {"scenario.max_range=5", "scenario.min_range=5"}), 1);
      }),
      AllOf(HasSubstr("min_range is not below max_range = 5"), HasSubstr("lower it")));
}

}  // namespace
}  // namespace montecarta::experiments
